#include "app/command.h"

namespace relume {

void addCompareCommand(CLI::App&) {}

} // namespace relume
