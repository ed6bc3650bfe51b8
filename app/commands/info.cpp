#include "app/command.h"

namespace relume {

void addInfoCommand(CLI::App&) {}

} // namespace relume
