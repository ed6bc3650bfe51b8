#include "app/offline/layer_ranks.h"

#include "app/offline/layer_join.h"
#include "app/offline/light_mix.h"
#include "assets/base/error.h"

#include <cstring>

namespace relume {
namespace {

/// Appends values to bytes.
class Packer {
public:
    void number(uint64_t value) { raw(&value, sizeof(value)); }
    void text(const std::string& text) {
        number(text.size());
        raw(text.data(), text.size());
    }
    void texts(const std::map<std::string, std::string>& texts) {
        number(texts.size());
        for (const auto& [name, value] : texts) {
            text(name);
            text(value);
        }
    }
    void image(const FloatImage& image) {
        number(image.width);
        number(image.height);
        number(image.channels.size());
        for (size_t i = 0; i < image.channels.size(); ++i) {
            text(image.channels[i]);
            number(image.planes[i].size());
            raw(image.planes[i].data(), image.planes[i].size() * sizeof(float));
        }
        texts(image.attributes);
    }
    void raw(const void* data, size_t size) {
        const auto* from = static_cast<const std::byte*>(data);
        bytes.insert(bytes.end(), from, from + size);
    }
    std::vector<std::byte> bytes;
};

/// Takes values from bytes that a Packer made, of this program on another rank.
class Unpacker {
public:
    explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}
    uint64_t number() {
        uint64_t value = 0;
        raw(&value, sizeof(value));
        return value;
    }
    std::string text() {
        std::string text(number(), '\0');
        raw(text.data(), text.size());
        return text;
    }
    std::map<std::string, std::string> texts() {
        std::map<std::string, std::string> texts;
        for (uint64_t left = number(); left > 0; --left) {
            const std::string name = text();
            texts[name] = text();
        }
        return texts;
    }
    FloatImage image() {
        FloatImage image;
        image.width = static_cast<uint32_t>(number());
        image.height = static_cast<uint32_t>(number());
        for (uint64_t left = number(); left > 0; --left) {
            image.channels.push_back(text());
            std::vector<float>& plane = image.planes.emplace_back(number());
            raw(plane.data(), plane.size() * sizeof(float));
        }
        image.attributes = texts();
        return image;
    }
    void raw(void* to, size_t size) {
        ASSERT(size <= bytes_.size());
        if (size > 0) std::memcpy(to, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
    }
    bool atEnd() const { return bytes_.empty(); }

private:
    std::span<const std::byte> bytes_;
};

} // namespace

std::vector<std::string> dealtLights(const std::vector<std::string>& lights, uint32_t rank, uint32_t ranks) {
    std::vector<std::string> dealt;
    for (size_t i = rank; i < lights.size(); i += ranks)
        dealt.push_back(lights[i]);
    return dealt;
}

std::vector<std::byte> packedLayers(const LayeredImage& image) {
    Packer packer;
    packer.image(image.composite);
    packer.number(image.layers.size());
    for (const LayeredImage::Layer& layer : image.layers) {
        packer.text(layer.name);
        packer.raw(&layer.weight, sizeof(layer.weight));
        packer.texts(layer.attributes);
        packer.image(layer.image);
    }
    return std::move(packer.bytes);
}

LayeredImage unpackedLayers(std::span<const std::byte> bytes) {
    Unpacker unpacker(bytes);
    LayeredImage image;
    image.composite = unpacker.image();
    for (uint64_t left = unpacker.number(); left > 0; --left) {
        LayeredImage::Layer& layer = image.layers.emplace_back();
        layer.name = unpacker.text();
        unpacker.raw(&layer.weight, sizeof(layer.weight));
        layer.attributes = unpacker.texts();
        layer.image = unpacker.image();
    }
    ASSERT(unpacker.atEnd());
    return image;
}

LayeredImage gatherLayers(Ranks& ranks, LayeredImage own) {
    if (ranks.alone()) return own;
    const bool sends = !ranks.speaks() && !own.layers.empty();
    const std::vector<std::byte> bytes = sends ? packedLayers(own) : std::vector<std::byte>();
    std::vector<uint64_t> sizes(ranks.count(), 0);
    sizes[ranks.rank()] = bytes.size();
    ranks.sum(sizes);
    std::vector<std::vector<std::byte>> others(ranks.count());
    std::vector<Ranks::Sent> sent;
    std::vector<Ranks::Received> received;
    if (sends) sent.push_back({0, bytes});
    if (ranks.speaks())
        for (uint32_t rank = 1; rank < ranks.count(); ++rank) {
            if (sizes[rank] == 0) continue;
            others[rank].resize(sizes[rank]);
            received.push_back({rank, others[rank]});
        }
    ranks.exchange(sent, received);
    if (!ranks.speaks()) return {};
    std::vector<LayerFile> files;
    files.push_back({"process 0", std::move(own)});
    for (uint32_t rank = 1; rank < ranks.count(); ++rank) {
        if (others[rank].empty()) continue;
        files.push_back({fmt::format("process {}", rank), unpackedLayers(others[rank])});
        others[rank] = {};
    }
    const bool joins = files.size() > 1;
    LayeredImage image = joinLayers(std::move(files));
    if (joins) mixLayers(image, {});
    return image;
}

} // namespace relume
