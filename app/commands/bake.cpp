#include "app/command.h"

namespace relume {

void addBakeCommand(CLI::App&) {}

} // namespace relume
