#include "app/command.h"

namespace relume {

void addDevicesCommand(CLI::App&) {}

} // namespace relume
