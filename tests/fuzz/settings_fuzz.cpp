// Whatever settings a file holds, those that are kept can be written and read again.
#include "app/viewer/state/preferences.h"
#include "tests/fuzz/fuzz.h"
#include "tests/text.h"

namespace relume::fuzz {

std::vector<std::string> corpus() {
    Preferences preferences;
    preferences.samples = 8;
    preferences.captureFolder = "shots";
    preferences.recent = {"/rooms/one.glb", "/rooms/two.glb"};
    Bookmark mark{"corner", {}};
    mark.camera.eye = {1, 2, 3};
    preferences.bookmarks["/rooms/one.glb"] = {mark, mark};
    const std::string path = besideInputs("written.json");
    writePreferences(path, preferences);
    return {bytesOf(path), "{}", "[]", R"({"bookmarks": {"a": [{"eye": [1e999, 0, 0]}]}, "window": 7})"};
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace relume;
    const Preferences read = readPreferences(fuzz::asFile(data, size, ".json"));
    const std::string once = fuzz::besideInputs("once.json"), twice = fuzz::besideInputs("twice.json");
    writePreferences(once, read);
    writePreferences(twice, readPreferences(once));
    fuzz::check(bytesOf(once) == bytesOf(twice), "settings that were written are not read as they were");
    return 0;
}
