#include "app/command.h"

namespace relume {

void addUnwrapCommand(CLI::App&) {}

} // namespace relume
