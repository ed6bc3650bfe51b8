#include "app/live/map_publisher.h"

#include "assets/base/error.h"
#include "assets/base/log.h"
#include "bake/layers/layer_solver.h"
#include "bake/vk/buffer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relume {
namespace {

// The CPU goes through inspected quantities: often enough to follow, seldom enough not to slow the bake.
constexpr double kInspectSeconds = 0.2;
// The widest filter reaches so many rings beyond a chart [texels].
constexpr uint32_t kFilterReach = 2;
// The ends of so many directions are shown as paths.
constexpr uint32_t kPaths = 64;

// Tells whether the content changes while a bake goes on.
bool follows(MapContent content) {
    return content == MapContent::LigIn || content == MapContent::LigOut || content == MapContent::Leaves ||
           content == MapContent::Error || content == MapContent::Layer;
}

// Tells whether the content is drawn as it is, without a unit: colours, directions and marks.
bool isPlain(MapContent content) {
    return content == MapContent::Normal || content == MapContent::Material ||
           content == MapContent::Leaves || content == MapContent::Seen;
}

struct Range {
    float low = 0, high = 0, largest = 0; // of R; the largest of all channels
};
Range rangeOf(const PatchValues& values, const PatchSet& patches) {
    Range range;
    for (uint32_t i = 0; i < patches.count; ++i) {
        const glm::vec4& v = values[i];
        range.low = i == 0 ? v.r : std::min(range.low, v.r);
        range.high = i == 0 ? v.r : std::max(range.high, v.r);
        range.largest = std::max({range.largest, std::abs(v.r), std::abs(v.g), std::abs(v.b)});
    }
    return range;
}

RowRange rowsOf(const std::vector<TexelArea>& areas) {
    RowRange rows;
    for (const TexelArea& area : areas)
        rows.add({area.y, area.y + area.height});
    return rows;
}

} // namespace

MapPublisher::MapPublisher(const vk::Device& device, LightmapExchange& exchange, const Desc& desc)
    : device_(device), exchange_(exchange), desc_(desc), probes_(device) {
    choose();
}

void MapPublisher::choose() {
    const auto& uuids = desc_.host.deviceUuids;
    constexpr uint32_t kProbe = 64; // [texels]; whether images can be shared does not depend on it
    std::string obstacle;
    if (!desc_.host.memoryObjects)
        obstacle = "OpenGL has no GL_EXT_memory_object_fd";
    else if (std::find(uuids.begin(), uuids.end(), device_.info().uuid) == uuids.end())
        obstacle = "OpenGL draws on another device";
    else if (!vk::SharedImage::possible(device_, kProbe, kProbe))
        obstacle = "Vulkan cannot export images";
    if (desc_.display == DisplayMode::Shared && !obstacle.empty())
        throw Error("--display shared: " + obstacle + ": use --display copied");
    shared_ = desc_.display != DisplayMode::Copied && obstacle.empty();
    if (shared_)
        choice_ = "shared (OpenGL and Vulkan use one device)";
    else
        choice_ = "copied (" + (desc_.display == DisplayMode::Copied ? "as asked for" : obstacle) + ")";
}

MapPublisher::Source MapPublisher::makeSource() const {
    const TransportSettings& transport = bake_->settings.solver.transport;
    // RTRad's preset fills one ring.
    const uint32_t rings = transport.rtrad ? std::min(bake_->rings, 1u) : bake_->rings;
    const Publisher::Desc desc{.rings = rings, .reflectivity = transport.reflectivity};
    return {.publisher = std::make_unique<Publisher>(device_, bake_->baker.patches(), desc),
            .bake = bake_->number,
            .radiance = transport.rtrad,
            .filled = rings >= kFilterReach};
}

void MapPublisher::begin(const Bake& bake) {
    bake_.emplace(bake);
    const SolverSettings& solver = bake.settings.solver;
    inspector_.emplace(PatchInspector::Input{.device = device_,
                                             .patches = bake.baker.patches(),
                                             .light = bake.baker.light(),
                                             .tracer = bake.baker.tracer(),
                                             .transport = solver.transport,
                                             .links = solver.links});
    next_ = makeSource();
    changed_.clear();
    drawnVersion_ = 0;
    edited_ = false;
    inspectedVersion_ = 0;
    probes_.forget();
}

void MapPublisher::edited(uint64_t number) {
    ASSERT(bake_);
    bake_->number = number;
    edited_ = true;
    for (Source* source : {&light_, &next_}) {
        if (!source->publisher || (source == &light_ && next_.publisher)) continue;
        source->bake = number;
        source->publisher->updateUnit(bake_->baker.patches());
    }
}

// Ends the bake. Texels that were drawn stay; what they were made of goes.
void MapPublisher::end() {
    next_ = {};
    inspected_ = {};
    inspector_.reset();
    bake_.reset();
}

LiveLight MapPublisher::askSolver() {
    LiveLight live = bake_->baker.solver().liveLight();
    changed_.insert(changed_.end(), live.changed.begin(), live.changed.end());
    changed_ = merged(std::move(changed_));
    return live;
}

bool MapPublisher::publish(const InspectRequest& request) {
    takeBackFormer();
    owes_ = false;
    const bool map = request.content == MapContent::Light ? publishLight() : publishInspected(request);
    return publishProbe() || map;
}

bool MapPublisher::publishProbe() {
    const auto* solver = bake_ ? dynamic_cast<const LayerSolver*>(&bake_->baker.solver()) : nullptr;
    if (solver == nullptr) return false;
    std::optional<LayerProbe> probe =
        probes_.next(*solver, [this](uint32_t texel) { return patchAt(texel); });
    if (!probe) return false;
    exchange_.publish(std::move(*probe));
    owes_ = true; // there may be more
    return true;
}

bool MapPublisher::publishLight() {
    LiveLight live;
    if (bake_) live = askSolver();
    const bool fresh =
        live.light && (live.version != drawnVersion_ || edited_) && (live.complete || !bake_->keepLight);
    const bool stale = anyShown_ && shown_.content != MapContent::Light && light_.publisher;
    if (!fresh && !stale) return false;
    const Publisher& publisher = *(fresh && next_.publisher ? next_ : light_).publisher;
    const std::optional<uint32_t> slot = claim(publisher.size());
    if (!slot) return false;
    if (fresh && next_.publisher) light_ = std::exchange(next_, {});
    if (fresh) {
        edited_ = false;
        std::vector<uint32_t> chunks;
        for (const ChunkRange& range : changed_) {
            for (uint32_t c = range.first; c < range.first + range.count; ++c)
                chunks.push_back(c);
        }
        changed_.clear();
        light_.publisher->update({.values = *live.light, .chunks = chunks, .unit = light_.publisher->unit()});
        drawnVersion_ = live.version;
    }
    write(light_, *slot,
          {.content = MapContent::Light,
           .complete = live.complete,
           .unit = light_.publisher->unit(),
           .ambient = light_.publisher->mean(),
           .radiance = light_.radiance});
    shown_ = {};
    return true;
}

bool MapPublisher::publishInspected(const InspectRequest& request) {
    if (!bake_) return false;
    const LiveLight live = askSolver();
    const bool asked = !anyShown_ || !(request == shown_) || inspected_.bake != bake_->number;
    const bool moved = follows(request.content) && live.version != inspectedVersion_;
    if (!asked && !moved) return false;
    if (!asked && secondsSince(inspectedAt_) < kInspectSeconds) {
        owes_ = true; // the last map of a bake must come, too
        return false;
    }
    if (!inspected_.publisher) inspected_ = makeSource();
    const std::optional<uint32_t> slot = claim(inspected_.publisher->size());
    if (!slot) return false;
    const PatchValues values = inspect(request);
    const Range range = rangeOf(values, bake_->baker.patches());
    const float unit = isPlain(request.content) ? 1.0f : unitFor(range.largest);
    inspected_.publisher->update({.values = vk::makeBuffer(device_, values, "inspected"),
                                  .chunks = inspected_.publisher->allChunks(),
                                  .unit = unit});
    inspected_.bake = bake_->number; // edits change the number
    write(inspected_, *slot,
          {.content = request.content,
           .light = request.light,
           .complete = live.complete,
           .unit = unit,
           .ambient = inspected_.publisher->mean(),
           .low = range.low,
           .high = range.high});
    shown_ = request;
    inspectedVersion_ = live.version;
    inspectedAt_ = Clock::now();
    return true;
}

PatchValues MapPublisher::inspect(const InspectRequest& request) {
    PatchInspector& inspector = *inspector_;
    Solver& solver = bake_->baker.solver();
    switch (request.content) {
    case MapContent::LigIn:
        return inspector.mip(inspector.ligIn(), request.mip);
    case MapContent::LigOut:
        return inspector.mip(inspector.ligOut(), request.mip);
    case MapContent::Position:
        return inspector.quantity(PatchQuantity::Position);
    case MapContent::Normal:
        return inspector.quantity(PatchQuantity::Normal);
    case MapContent::Material:
        return inspector.quantity(PatchQuantity::Albedo);
    case MapContent::Area:
        return inspector.quantity(PatchQuantity::Area);
    case MapContent::Leaves:
        return leafColors(request.preview);
    case MapContent::Error: {
        const std::vector<float> errors = solver.errors();
        if (!errors.empty()) return PatchInspector::grey(errors);
        break; // it cannot be told yet
    }
    case MapContent::Seen: {
        const uint32_t patch = patchAt(request.texel);
        if (patch != shader::kNoPatch) return inspector.seenFrom(patch);
        break; // beside all charts nothing is seen
    }
    case MapContent::Layer:
        return layerOf(request);
    case MapContent::Light:
        break;
    }
    return PatchValues(bake_->baker.patches().scene.patches.size(), glm::vec4(0.0f));
}

// Returns one light's layer times its weight, for which no ray is traced. It is dark where the light has
// none.
PatchValues MapPublisher::layerOf(const InspectRequest& request) {
    PatchValues values(bake_->baker.patches().scene.patches.size(), glm::vec4(0.0f));
    const auto* solver = dynamic_cast<const LayerSolver*>(&bake_->baker.solver());
    if (solver == nullptr) return values;
    for (const std::unique_ptr<Layer>& layer : solver->layers()) {
        const Layer* shown = layer->source.key == request.light ? layer->shown() : nullptr;
        if (shown != nullptr) values = solver->layerLight(*shown);
    }
    for (glm::vec4& value : values)
        value = glm::vec4(glm::vec3(value) * request.weight, 0.0f);
    return values;
}

PatchValues MapPublisher::leafColors(const PairSettings& preview) {
    const SolverSettings& solver = bake_->settings.solver;
    const PairSettings& own = solver.method == Method::Adaptive ? solver.pairs : preview;
    PatchValues leaves = inspector_->leaves(
        inspector_->ligIn(), {.node = own.node, .threshold = static_cast<float>(own.threshold)});
    for (glm::vec4& leaf : leaves)
        leaf.r = 0.5f * std::log2(std::max(leaf.r, 1.0f));
    return leaves;
}

uint32_t MapPublisher::patchAt(uint32_t texel) const {
    const uint32_t size = bake_->baker.patches().scene.size;
    return texel < size * size ? inspector_->patchAt(texel % size, texel / size) : shader::kNoPatch;
}

// Claims a slot for maps of this size. Where there is none yet, it notes that a map is owed.
std::optional<uint32_t> MapPublisher::claim(uint32_t size) {
    if (shared_ && exchange_.refused()) {
        if (desc_.display == DisplayMode::Shared)
            throw Error("--display shared: OpenGL did not take the images: use --display copied");
        shared_ = false;
        choice_ = "copied (OpenGL did not take the images)";
        spdlog::warn("display: {}", choice_);
        setSize_ = 0;
    }
    if (size != setSize_) {
        setSize_ = size;
        offer();
    }
    const std::optional<uint32_t> slot = exchange_.claim();
    owes_ = !slot;
    return slot;
}

void MapPublisher::offer() {
    if (images_[0].handle() != VK_NULL_HANDLE) former_.push_back({set_, std::move(images_)});
    images_ = {};
    MapOffer offer{.set = ++set_, .size = setSize_, .shared = shared_};
    if (shared_) {
        for (uint32_t slot = 0; slot < Publisher::kSlots; ++slot) {
            images_[slot] =
                vk::SharedImage(device_, {.width = setSize_, .height = setSize_, .name = "shared lightmap"});
            offer.fds[slot] = images_[slot].exportFd();
        }
        offer.memorySize = images_[0].memorySize();
    }
    exchange_.offer(offer);
    for (Source* source : {&light_, &next_, &inspected_}) {
        if (source->publisher) source->publisher->forget();
    }
}

// Destroys images that nobody draws with any more.
void MapPublisher::takeBackFormer() {
    std::erase_if(former_,
                  [&](const FormerImages& images) { return exchange_.retiredBefore(images.set + 1); });
}

void MapPublisher::write(Source& source, uint32_t slot, PublishedMap map) {
    Publisher& publisher = *source.publisher;
    // The slots may hold what another source wrote, which this one does not know.
    if (writer_ != &publisher) publisher.forget();
    writer_ = &publisher;
    const std::vector<TexelArea> areas =
        shared_ ? publisher.publish(images_[slot], slot) : publisher.publish(exchange_.memory(slot), slot);
    map.slot = slot;
    map.set = set_;
    map.bake = source.bake;
    map.filled = source.filled;
    map.changed = rowsOf(areas);
    exchange_.publish(map);
    anyShown_ = true;
}

std::vector<glm::vec4> MapPublisher::lightNow() {
    const LiveLight live = askSolver();
    const size_t patches = bake_->baker.patches().scene.patches.size();
    if (!live.light) return std::vector<glm::vec4>(patches, glm::vec4(0.0f));
    return vk::readBuffer<glm::vec4>(device_, *live.light, patches);
}

std::optional<InspectPaths> MapPublisher::paths(uint32_t texel) {
    const uint32_t patch = patchAt(texel);
    if (patch == shader::kNoPatch) return std::nullopt;
    InspectPaths paths{.from = glm::vec3(bake_->baker.patches().scene.patches[patch].position), .ends = {}};
    for (const PatchInspector::Link& link : inspector_->links(patch, kPaths))
        paths.ends.push_back(link.end);
    return paths;
}

InspectVoxels MapPublisher::voxels(uint32_t resolution) const {
    PatchInspector::Voxels voxels = inspector_->voxels(resolution);
    return {.edge = voxels.edge, .centres = std::move(voxels.centres)};
}

} // namespace relume
