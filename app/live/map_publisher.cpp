#include "app/live/map_publisher.h"

#include "assets/base/error.h"
#include "bake/layers/layer_solver.h"
#include "bake/vk/buffer.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

// The widest filter reaches so many rings beyond a chart [texels].
constexpr uint32_t kFilterReach = 2;

} // namespace

MapPublisher::MapPublisher(const vk::Device& device, LightmapExchange& exchange, const MapSlots::Desc& desc)
    : device_(device), exchange_(exchange), slots_(device, exchange, desc), probes_(device) {}

MapSource MapPublisher::makeSource() const {
    const Bake& bake = running_->bake;
    const TransportSettings& transport = bake.settings.solver.transport;
    // RTRad's preset fills one ring.
    const uint32_t rings = transport.rtrad ? std::min(bake.rings, 1u) : bake.rings;
    const Publisher::Desc desc{.rings = rings, .reflectivity = transport.reflectivity};
    return {.publisher = std::make_unique<Publisher>(device_, bake.baker.patches(), desc),
            .bake = bake.number,
            .radiance = transport.rtrad,
            .filled = rings >= kFilterReach};
}

void MapPublisher::begin(const Bake& bake) {
    running_.emplace(Running{bake, BakeInspection(device_, bake.baker, bake.settings.solver)});
    light_.begin(makeSource(), bake.kept);
    inspected_.version = 0;
    probes_.forget();
}

void MapPublisher::edited(uint64_t number) {
    ASSERT(running_);
    running_->bake.number = number;
    light_.edited(number, running_->bake.baker.patches());
}

void MapPublisher::end() {
    light_.end();
    inspected_.source = {};
    running_.reset();
}

LiveLight MapPublisher::askSolver() {
    const LayerSolver* layers = running_->bake.baker.layers();
    return light_.ask(running_->bake.baker.solver(), layers == nullptr || layers->current());
}

bool MapPublisher::publish(const InspectRequest& request) {
    slots_.takeBackFormer();
    owes_ = false;
    const bool map = request.content == MapContent::Light ? publishLight() : publishInspected(request);
    return publishProbe() || map;
}

bool MapPublisher::publishProbe() {
    const LayerSolver* solver = running_ ? running_->bake.baker.layers() : nullptr;
    if (solver == nullptr) return false;
    std::optional<LayerProbe> probe =
        probes_.next(*solver, [this](uint32_t texel) { return running_->inspection.patchAt(texel); });
    if (!probe) return false;
    exchange_.publish(std::move(*probe));
    owes_ = true; // there may be more
    return true;
}

bool MapPublisher::publishLight() {
    LiveLight live;
    if (running_) live = askSolver();
    const LightMapStep step = light_.decide(live, shown_ && shown_->content != MapContent::Light);
    if (step == LightMapStep::None) return false;
    const std::optional<uint32_t> slot = claim(light_.size(step));
    if (!slot) return false;
    const MapSource& source = light_.draw(step, live);
    hand(source, *slot,
         {.content = MapContent::Light,
          .complete = live.complete,
          .current = light_.current(),
          .unit = source.publisher->unit(),
          .ambient = source.publisher->mean(),
          .radiance = source.radiance});
    shown_ = InspectRequest();
    return true;
}

bool MapPublisher::publishInspected(const InspectRequest& request) {
    if (!running_) return false;
    const LiveLight live = askSolver();
    const uint64_t number = running_->bake.number;
    MapSource& source = inspected_.source;
    const InspectedMapStep step =
        decideInspectedMap({.asked = !shown_ || !(request == *shown_) || source.bake != number,
                            .changed = follows(request.content) && live.version != inspected_.version,
                            .secondsSince = secondsSince(inspected_.at)});
    if (step == InspectedMapStep::Wait) owes_ = true; // the last map of a bake must come, too
    if (step != InspectedMapStep::Draw) return false;
    if (!source.publisher) source = makeSource();
    const std::optional<uint32_t> slot = claim(source.publisher->size());
    if (!slot) return false;
    const PatchValues values = running_->inspection.values(request);
    const ValueRange range = rangeOf(values, running_->bake.baker.patches());
    const float unit = isPlain(request.content) ? 1.0f : unitFor(range.largest);
    source.publisher->update({.values = vk::makeBuffer(device_, values, "inspected"),
                              .chunks = source.publisher->allChunks(),
                              .unit = unit});
    source.bake = number; // edits change the number
    hand(source, *slot,
         {.content = request.content,
          .light = request.light,
          .complete = live.complete,
          .unit = unit,
          .ambient = source.publisher->mean(),
          .low = range.low,
          .high = range.high});
    shown_ = request;
    inspected_.version = live.version;
    inspected_.at = Clock::now();
    return true;
}

// Claims a slot for maps of this size. Where there is none yet, it notes that a map is owed.
std::optional<uint32_t> MapPublisher::claim(uint32_t size) {
    const std::optional<uint32_t> slot = slots_.claim(size);
    owes_ = !slot;
    return slot;
}

void MapPublisher::hand(const MapSource& source, uint32_t slot, PublishedMap map) {
    map.bake = source.bake;
    map.filled = source.filled;
    slots_.publish(*source.publisher, slot, map);
}

std::vector<glm::vec4> MapPublisher::lightNow() {
    const LiveLight live = askSolver();
    const size_t patches = running_->bake.baker.patches().scene.patches.size();
    if (!live.light) return std::vector<glm::vec4>(patches, glm::vec4(0.0f));
    return vk::readBuffer<glm::vec4>(device_, *live.light, patches);
}

} // namespace relume
