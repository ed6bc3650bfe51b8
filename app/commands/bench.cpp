#include "app/command.h"

namespace relume {

void addBenchCommand(CLI::App&) {}

} // namespace relume
