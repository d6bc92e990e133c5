// placeholder until the chart lands
#include "commands.h"
namespace gnomon::cli {
void add_chart(CLI::App&) {}
}  // namespace gnomon::cli
