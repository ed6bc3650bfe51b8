#include "app/command.h"

namespace relume {

void addSceneCommand(CLI::App&) {}

} // namespace relume
