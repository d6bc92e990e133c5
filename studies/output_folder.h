// Output that is either there in full or not at all: everything is written beside its place and renamed into it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gnomon::studies {

/// Creates the folders of `path` that are missing; takes back those that are still empty when it goes.
class CreatedFolders {
public:
    /// Throws Error that starts with `what` when a folder cannot be created.
    CreatedFolders(const std::filesystem::path& path, const std::string& what);
    ~CreatedFolders();
    CreatedFolders(const CreatedFolders&) = delete;
    CreatedFolders& operator=(const CreatedFolders&) = delete;

private:
    std::vector<std::filesystem::path> created_;  // outermost first
};

/// A folder of results. Files that others put there are left alone.
class OutputFolder {
public:
    /// Checks that the folder can be written by creating the hidden place where files are prepared. Throws Error.
    explicit OutputFolder(const std::filesystem::path& path);
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    /// Where a file is to be written before commit(). A name may lead into folders inside; they are made.
    [[nodiscard]] std::filesystem::path file(const std::string& name) const;

    /// The names of the files that lie in a folder inside now, such as "frames/0000_color.png", sorted.
    [[nodiscard]] std::vector<std::string> files_in(const std::string& folder) const;

    /// Throws Error when one of the names is a folder already, so that commit() could not replace it, or leads through a file.
    void check_replaceable(const std::vector<std::string>& owned) const;

    /// Moves every prepared file into the folder. Of the names in `owned`, those that were not prepared now are removed: they
    /// are left from an earlier run. The last of `owned` vanishes first and comes last, so where it is, the others fit to it.
    void commit(const std::vector<std::string>& owned);

private:
    std::filesystem::path path_;
    CreatedFolders parents_;
    std::filesystem::path staging_;
};

/// One file. Throws Error when it cannot be created.
class OutputFile {
public:
    /// `what` is how errors call the file, as an option and its value.
    OutputFile(const std::filesystem::path& path, const std::string& what);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Where to write before commit(); the file exists and is empty.
    [[nodiscard]] const std::filesystem::path& staging() const { return staging_; }
    void commit();

private:
    std::filesystem::path path_;
    std::string what_;
    std::filesystem::path staging_;
};

}  // namespace gnomon::studies
