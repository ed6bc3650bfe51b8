#include "assets/gltf/edit/gltf_edit_entries.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <functional>
#include <utility>

namespace relume::gltf {

LightEntries::LightEntries(FileEdit& edit, const char* extension) : edit_(edit), extension_(extension) {
    if (const EditedJson* entries = list()) users_.resize(entries->size());
    const EditedJson* nodes = find(edit.json, {"nodes"});
    for (size_t node = 0; nodes && node < nodes->size(); ++node)
        if (const int entry = entryOf(static_cast<int>(node)); entry >= 0)
            ++users_[static_cast<size_t>(entry)];
}

EditedJson* LightEntries::list() const {
    EditedJson* entries = find(edit_.json, {"extensions", extension_, "lights"});
    return entries && entries->is_array() ? entries : nullptr;
}

int LightEntries::entryOf(int node) const {
    EditedJson* nodes = find(edit_.json, {"nodes"});
    if (!nodes || node < 0 || static_cast<size_t>(node) >= nodes->size()) return -1;
    const EditedJson* use = find((*nodes)[static_cast<size_t>(node)], {"extensions", extension_, "light"});
    return use && use->is_number_unsigned() && use->get<uint64_t>() < users_.size() ? use->get<int>() : -1;
}

EditedJson& LightEntries::own(int node) {
    const auto index = static_cast<size_t>(entryOf(node));
    EditedJson& lights = *list();
    if (!lights[index].is_object())
        edit_.fail(fmt::format("entry {} of the lights of {} is no object", index, extension_));
    if (users_[index] == 1) return lights[index];
    --users_[index];
    users_.push_back(1);
    *find(edit_.json["nodes"][static_cast<size_t>(node)], {"extensions", extension_, "light"}) =
        lights.size();
    EditedJson copy = lights[index];
    lights.push_back(std::move(copy));
    return lights.back();
}

void LightEntries::add(int node, EditedJson entry) {
    EditedJson& lights = make(edit_, edit_.json, {"extensions", extension_, "lights"}, "the file");
    if (lights.is_null()) lights = EditedJson::array();
    if (!lights.is_array()) edit_.fail("the file's list of lights is no array");
    lights.push_back(std::move(entry));
    users_.push_back(1);
    make(edit_, edit_.json["nodes"][static_cast<size_t>(node)], {"extensions", extension_, "light"},
         fmt::format("nodes[{}]", node)) = users_.size() - 1;
    useExtension(edit_, extension_);
}

void LightEntries::remove(int node) {
    const int entry = entryOf(node);
    if (entry < 0) return;
    unused_.push_back(entry);
    --users_[static_cast<size_t>(entry)];
    erase(edit_.json["nodes"][static_cast<size_t>(node)], {"extensions", extension_});
}

void LightEntries::dropUnused() {
    if (unused_.empty() || edit_.hasPointers) return;
    std::sort(unused_.begin(), unused_.end(), std::greater<>());
    unused_.erase(std::unique(unused_.begin(), unused_.end()), unused_.end());
    EditedJson& lights = *list();
    for (const int index : unused_) {
        if (users_[static_cast<size_t>(index)] > 0) continue;
        if (lights.size() == 1) { // glTF has no empty list
            if (find(edit_.json, {"extensions", extension_})->size() > 1) return;
            erase(edit_.json, {"extensions", extension_});
            dropExtension(edit_, extension_);
            return;
        }
        lights.erase(static_cast<size_t>(index));
        for (EditedJson& node : edit_.json["nodes"])
            if (EditedJson* use = find(node, {"extensions", extension_, "light"}); use && *use > index)
                *use = use->get<int>() - 1;
    }
}

} // namespace relume::gltf
