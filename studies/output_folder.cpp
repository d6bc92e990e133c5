#include "studies/output_folder.h"

#include "sim/error.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace gnomon::studies {

namespace {

namespace fs = std::filesystem;

/// Absolute and without a separator at the end.
fs::path plain(const fs::path& path, const std::string& what) {
    if (path.empty()) fail("{}: the path is empty", what);
    std::error_code error;
    fs::path full = fs::absolute(path, error).lexically_normal();
    if (error) fail("{}: {}", what, error.message());
    return full.has_filename() ? full : full.parent_path();
}

/// A name for something that nobody should see for long.
fs::path hidden_name(const fs::path& name, int attempt) {
    return fmt::format(".{}.gnomon-{}-{}", name.string(), ::getpid(), attempt);
}

bool is_folder(const fs::path& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

std::string out_option(const fs::path& path) { return fmt::format("--out {}", path.string()); }

/// In the folder when it is there (so that renaming stays on one file system), beside it when not.
fs::path make_staging(const fs::path& path, const std::string& what) {
    const fs::path place = is_folder(path) ? path : path.parent_path();
    for (int attempt = 0; attempt < 1000; ++attempt) {
        fs::path staging = place / hidden_name(path.filename(), attempt);
        std::error_code error;
        if (fs::create_directory(staging, error)) return staging;
        if (error) fail("{}: cannot be written: {}", what, error.message());
    }
    fail("{}: cannot be written: too many folders of earlier runs", what);
}

void move_file(const fs::path& from, const fs::path& to, const std::string& what) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) fail("{}: {} cannot be written: {}", what, to.filename().string(), error.message());
}

}  // namespace

CreatedFolders::CreatedFolders(const fs::path& path, const std::string& what) {
    std::vector<fs::path> missing;
    std::error_code error;
    for (fs::path at = plain(path, what); !fs::exists(at, error) && at.has_relative_path(); at = at.parent_path())
        missing.push_back(at);
    std::ranges::reverse(missing);
    for (const fs::path& folder : missing) {
        const bool made = fs::create_directory(folder, error);
        if (made) created_.push_back(folder);
        if (made || (!error && is_folder(folder))) continue;
        for (auto it = created_.rbegin(); it != created_.rend(); ++it) fs::remove(*it, error);
        fail("{}: the folder {} cannot be created", what, folder.string());
    }
    if (!is_folder(plain(path, what))) fail("{}: {} is not a folder", what, path.string());
}

CreatedFolders::~CreatedFolders() {
    std::error_code still_in_use;
    for (auto it = created_.rbegin(); it != created_.rend(); ++it) fs::remove(*it, still_in_use);
}

OutputFolder::OutputFolder(const fs::path& path)
    : path_(plain(path, out_option(path))), parents_(path_.parent_path(), out_option(path)) {
    std::error_code ignored;
    if (fs::exists(path_, ignored) && !is_folder(path_)) fail("{}: exists and is not a folder", out_option(path));
    if (fs::is_symlink(path_, ignored) && !is_folder(path_)) fail("{}: is a link to nothing", out_option(path));
    staging_ = make_staging(path_, out_option(path));
}

fs::path OutputFolder::file(const std::string& name) const {
    fs::path path = staging_ / name;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) fail("{}: {} cannot be written: {}", out_option(path_), name, error.message());
    return path;
}

std::vector<std::string> OutputFolder::files_in(const std::string& folder) const {
    std::vector<std::string> names;
    std::error_code ignored;
    for (fs::directory_iterator at(path_ / folder, ignored), end; at != end; at.increment(ignored))
        if (!at->is_directory(ignored)) names.push_back(folder + "/" + at->path().filename().string());
    std::ranges::sort(names);
    return names;
}

void OutputFolder::check_replaceable(const std::vector<std::string>& owned) const {
    std::error_code ignored;
    for (const std::string& name : owned) {
        if (is_folder(path_ / name)) fail("{}: {} is a folder there, expected a file to replace", out_option(path_), name);
        const fs::path inside = (path_ / name).parent_path();
        if (fs::exists(inside, ignored) && !is_folder(inside))
            fail("{}: {} is not a folder there", out_option(path_), inside.filename().string());
    }
}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    if (!staging_.empty()) fs::remove_all(staging_, ignored);
}

void OutputFolder::commit(const std::vector<std::string>& owned) {
    check_replaceable(owned);

    // A new folder appears with all its files at once.
    std::error_code error;
    if (!fs::exists(path_, error)) {
        fs::rename(staging_, path_, error);
        if (!error) {
            staging_.clear();
            return;
        }
    }

    // In a folder that is there, files are replaced one by one, the one that describes them last.
    for (auto name = owned.rbegin(); name != owned.rend(); ++name) {
        const bool prepared = fs::exists(staging_ / *name, error);
        if (!prepared || name == owned.rbegin()) fs::remove(path_ / *name, error);
    }
    for (const std::string& name : owned) {
        if (!fs::exists(staging_ / name, error)) continue;
        fs::create_directories((path_ / name).parent_path(), error);
        move_file(staging_ / name, path_ / name, out_option(path_));
    }
}

OutputFile::OutputFile(const fs::path& path, const std::string& what) : path_(plain(path, what)), what_(what) {
    if (is_folder(path_)) fail("{}: is a folder, expected a file", what_);
    if (!is_folder(path_.parent_path())) fail("{}: there is no folder {}", what_, path_.parent_path().string());
    for (int attempt = 0; staging_.empty(); ++attempt) {
        const fs::path candidate = path_.parent_path() / hidden_name(path_.filename(), attempt);
        std::error_code ignored;
        if (!fs::exists(candidate, ignored)) staging_ = candidate;
    }
    if (!std::ofstream(staging_, std::ios::binary)) fail("{}: cannot be written", what_);
}

OutputFile::~OutputFile() {
    std::error_code ignored;
    if (!staging_.empty()) fs::remove(staging_, ignored);
}

void OutputFile::commit() {
    move_file(staging_, path_, what_);
    staging_.clear();
}

}  // namespace gnomon::studies
