// gnomon contact-sheet: one page over many results.
#include "commands.h"

#include "sim/error.h"
#include "studies/contact_sheet.h"
#include "studies/output_folder.h"

#include <cstdio>
#include <fstream>

namespace gnomon::cli {

namespace {

void make_contact_sheet(const std::string& folder) {
    const studies::ContactSheet sheet = studies::read_contact_sheet(folder);
    const std::filesystem::path page = std::filesystem::path(folder) / "index.html";
    studies::OutputFile file(page, page.string());
    std::ofstream stream(file.staging(), std::ios::binary);
    stream << studies::contact_sheet_html(sheet);
    stream.close();
    if (!stream) fail("{}: cannot be written", page.string());
    file.commit();
    std::size_t results = 0;
    for (const studies::SheetRow& row : sheet.rows) results += row.entries.size();
    fmt::print("{}: {} results in {} rows\n", page.string(), results, sheet.rows.size());
}

}  // namespace

void add_contact_sheet(CLI::App& app) {
    CLI::App* command = app.add_subcommand("contact-sheet", "Gather results below a folder on one page, DIR/index.html");
    const auto folder = std::make_shared<std::string>();
    command->add_option("dir", *folder, "Folder with the results of 'gnomon render', at any depth")
        ->type_name("DIR")
        ->required();
    command->callback([folder] { make_contact_sheet(*folder); });
}

}  // namespace gnomon::cli
