#include "bake/output/checkpoint.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/file_write.h"
#include "bake/lights/lamps.h"
#include "bake/surface/patches.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <system_error>
#include <type_traits>

namespace relume {
namespace {

// The file has a magic, then sections, each behind its number of bytes as 64 bits: version, settings, scene,
// counters, pass times, the solver's own struct and its parts; last comes the hash of all before it.
constexpr std::string_view kMagic = "relume checkpoint 11\n", kMagicName = "relume checkpoint ";
static_assert(std::endian::native == std::endian::little, "files are little endian");
static_assert(std::is_trivially_copyable_v<SolverCounters>);

constexpr uint64_t kPiece = 8u << 20; // [bytes] read or written at a time

// This is [Fowler, Noll and Vo]'s hash over words of eight bytes, the last one padded by zeros: pieces whose
// size is a multiple of eight may be added one by one. A step can be undone, so two texts that differ in one
// word never have the same hash.
class Hash {
public:
    void add(const void* data, size_t size) {
        const auto* bytes = static_cast<const uint8_t*>(data);
        for (; size > 0; bytes += sizeof(uint64_t)) {
            uint64_t word = 0;
            const size_t count = std::min(size, sizeof(word));
            std::memcpy(&word, bytes, count);
            mix(word);
            size -= count;
        }
    }
    template<typename T>
    void add(const std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        add(uint64_t{values.size()});
        add(values.data(), values.size() * sizeof(T));
    }
    void add(uint64_t word) { mix(word); }
    uint64_t value() const { return value_; }

private:
    void mix(uint64_t word) {
        value_ = (value_ ^ word) * 0x100000001b3ull;
        value_ ^= value_ >> 32; // else high bits of a word would never reach low ones
    }
    uint64_t value_ = 0xcbf29ce484222325ull;
};

// Writes a file in pieces of whole words, and hashes them.
class Writer {
public:
    Writer(const std::string& path, OnFailure onFailure) : file_(path, onFailure) {
        pending_.reserve(kPiece);
    }
    void bytes(const void* data, uint64_t size) {
        const char* from = static_cast<const char*>(data);
        while (size > 0) {
            const uint64_t count = std::min(size, kPiece - pending_.size());
            pending_.append(from, count);
            if (pending_.size() == kPiece) flush();
            from += count;
            size -= count;
        }
    }
    void section(const void* data, uint64_t size) {
        bytes(&size, sizeof(size));
        bytes(data, size);
    }
    void part(const StatePart& part) {
        bytes(&part.bytes, sizeof(part.bytes));
        std::vector<char> piece(std::min(part.bytes, kPiece));
        for (uint64_t done = 0; done < part.bytes; done += piece.size()) {
            const uint64_t count = std::min<uint64_t>(piece.size(), part.bytes - done);
            part.read(piece.data(), done, count);
            bytes(piece.data(), count);
        }
    }
    /// Writes the hash and returns the file's size.
    uint64_t finish() {
        flush();
        const uint64_t hash = hash_.value();
        file_.write({reinterpret_cast<const char*>(&hash), sizeof(hash)});
        file_.commit();
        return size_ + sizeof(hash);
    }

private:
    void flush() {
        hash_.add(pending_.data(), pending_.size());
        file_.write(pending_);
        size_ += pending_.size();
        pending_.clear();
    }
    AtomicFile file_;
    std::string pending_;
    Hash hash_;
    uint64_t size_ = 0;
};

// Returns "samples=64 there, samples=32 here": the first pair that differs, or that only one of them has.
std::string difference(std::string_view mine, std::string_view theirs) {
    std::istringstream a{std::string(mine)}, b{std::string(theirs)};
    std::string x, y;
    do {
        x = y = "nothing";
        a >> x;
        b >> y;
    } while (x == y && (a || b));
    return y + " there, " + x + " here";
}

void addMaterial(Hash& hash, const Material& m) {
    const auto add = [&](const auto& value) { hash.add(&value, sizeof(value)); };
    const auto texture = [&](const TextureRef& ref) {
        add(ref.texture);
        add(ref.texCoord);
        add(ref.transform);
    };
    add(m.baseColor);
    add(m.emission);
    add(m.metallic);
    add(m.roughness);
    add(m.alphaMode);
    add(m.alphaCutoff);
    add(m.doubleSided);
    texture(m.baseColorTexture);
    texture(m.emissionTexture);
    texture(m.metallicRoughnessTexture);
}

} // namespace

uint64_t sceneFingerprint(const Scene& scene, const PatchSet& patches) {
    Hash hash;
    hash.add(patches.scene.patches);
    hash.add(patches.edges);
    hash.add(patches.albedo);
    hash.add(patches.emission);
    hash.add(patches.scene.patchChart);
    hash.add(patches.scene.texelToPatch);
    hash.add(patches.scene.hitTriangles);
    hash.add(patches.scene.alphaTriangles);
    hash.add(patches.scene.alphaTexels);
    const WorldMesh& mesh = patches.scene.mesh;
    hash.add(mesh.positions);
    hash.add(mesh.normals);
    for (const auto* uv : {&mesh.lightmapUv, &mesh.baseUv, &mesh.emissionUv, &mesh.metallicUv})
        hash.add(*uv);
    hash.add(mesh.colors);
    hash.add(mesh.material);
    hash.add(mesh.chart);
    for (const Material& material : scene.materials)
        addMaterial(hash, material);
    for (const Texture& texture : scene.textures) {
        hash.add(static_cast<uint64_t>(texture.image));
        hash.add(static_cast<uint64_t>(texture.wrapS) << 2 | static_cast<uint64_t>(texture.wrapT));
        hash.add(uint64_t{texture.nearest});
    }
    for (const Image& image : scene.images) {
        hash.add(uint64_t{image.width} << 32 | image.height);
        hash.add(image.rgba);
    }
    const LampSet lamps = buildLamps(scene, mesh, {.samples = 1});
    hash.add(lamps.lamps);
    hash.add(lamps.skyPixels);
    hash.add(&lamps.skyRotation, sizeof(lamps.skyRotation));
    return hash.value();
}

uint64_t saveCheckpoint(const std::string& path, const CheckpointKey& key, Solver& solver,
                        OnFailure onFailure) {
    const SolverState state = solver.state();
    const std::vector<StatePart> parts = solver.stateParts();
    Writer writer(path, onFailure);
    writer.bytes(kMagic.data(), kMagic.size());
    writer.section(key.version.data(), key.version.size());
    writer.section(key.settings.data(), key.settings.size());
    writer.section(&key.scene, sizeof(key.scene));
    writer.section(&state.counters, sizeof(state.counters));
    writer.section(state.passSeconds.data(), state.passSeconds.size() * sizeof(double));
    writer.section(state.own.data(), state.own.size());
    for (const StatePart& part : parts)
        writer.part(part);
    return writer.finish();
}

uint64_t checkpointHash(std::string_view bytes) {
    Hash hash;
    hash.add(bytes.data(), bytes.size());
    return hash.value();
}

Checkpoint::Checkpoint(const std::string& path, const std::string& version) : path_(path) {
    refuseOddKind(path, "name a file that --checkpoint wrote");
    file_.open(path, std::ios::binary);
    if (!file_ || file_.peek() == std::ifstream::traits_type::eof()) {
        const int error = file_.is_open() ? 0 : errno;
        fail((error != 0 ? "cannot read: " + std::generic_category().message(error) : "is empty") +
             ": name a file that --checkpoint wrote");
    }
    check();
    readHeader(version);
}

// Checks magic and hash: beyond this point every size in the file is what was written.
void Checkpoint::check() {
    file_.seekg(0, std::ios::end);
    const auto size = static_cast<uint64_t>(file_.tellg());
    std::string magic(std::min<uint64_t>(size, kMagic.size()), '\0');
    read(0, magic.data(), magic.size());
    if (!magic.starts_with(kMagicName)) fail("is no checkpoint: name a file that --checkpoint wrote");
    if (magic != kMagic) fail("is a checkpoint of another version of Relume: bake from the start");
    uint64_t told = 0;
    if (size < kMagic.size() + sizeof(told)) fail("is damaged: bake from the start");
    end_ = size - sizeof(told);
    read(end_, &told, sizeof(told));
    Hash hash;
    std::vector<char> piece(std::min(end_, kPiece));
    for (uint64_t done = 0; done < end_; done += piece.size()) {
        const uint64_t count = std::min<uint64_t>(piece.size(), end_ - done);
        read(done, piece.data(), count);
        hash.add(piece.data(), count);
    }
    if (hash.value() != told) fail("is damaged: bake from the start");
}

void Checkpoint::readHeader(const std::string& version) {
    uint64_t offset = kMagic.size();
    const std::string theirs = text(nextSection(offset));
    if (theirs != version)
        fail("was written by Relume " + theirs + ", this is " + version + ": bake from the start");
    settings_ = text(nextSection(offset));
    const auto scene = values<uint64_t>(nextSection(offset));
    const auto counters = values<SolverCounters>(nextSection(offset));
    if (scene.size() != 1 || counters.size() != 1) fail("is damaged: bake from the start");
    scene_ = scene[0];
    state_.counters = counters[0];
    state_.passSeconds = values<double>(nextSection(offset));
    state_.own = values<uint8_t>(nextSection(offset));
    while (offset < end_)
        parts_.push_back(nextSection(offset));
}

Checkpoint::Section Checkpoint::nextSection(uint64_t& offset) {
    Section section;
    if (end_ - offset < sizeof(section.size)) fail("is damaged: bake from the start");
    read(offset, &section.size, sizeof(section.size));
    section.offset = offset + sizeof(section.size);
    if (end_ - section.offset < section.size) fail("is damaged: bake from the start");
    offset = section.offset + section.size;
    return section;
}

std::string Checkpoint::text(const Section& section) {
    const std::vector<char> bytes = values<char>(section);
    return {bytes.begin(), bytes.end()};
}

template<typename T>
std::vector<T> Checkpoint::values(const Section& section) {
    if (section.size % sizeof(T) != 0) fail("is damaged: bake from the start");
    std::vector<T> result(section.size / sizeof(T));
    read(section.offset, result.data(), section.size);
    return result;
}

void Checkpoint::read(uint64_t offset, void* data, uint64_t size) {
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(offset));
    file_.read(static_cast<char*>(data), static_cast<std::streamsize>(size));
    if (!file_) fail("cannot be read to its end: bake from the start");
}

// Throws Error. What the file says of itself may hold anything: messages stay on one line.
void Checkpoint::fail(std::string why) const {
    std::replace_if(
        why.begin(), why.end(), [](unsigned char c) { return c < 0x20; }, ' ');
    throw Error(path_ + ": " + why);
}

void Checkpoint::restore(const CheckpointKey& key, Solver& solver) {
    if (settings_ != key.settings) {
        fail("belongs to a bake with other settings (" + difference(key.settings, settings_) +
             "): give the same options or bake from the start");
    }
    if (scene_ != key.scene)
        fail("belongs to another scene, or this one has changed since: bake from the start");
    const std::vector<StatePart> parts = solver.stateParts();
    const bool fit = std::equal(parts.begin(), parts.end(), parts_.begin(), parts_.end(),
                                [](const StatePart& a, const Section& b) { return a.bytes == b.size; });
    if (!fit || state_.own.size() != solver.state().own.size())
        fail("does not fit this bake: bake from the start");
    for (size_t i = 0; i < parts.size(); ++i) {
        std::vector<char> piece(std::min(parts[i].bytes, kPiece));
        for (uint64_t done = 0; done < parts[i].bytes; done += piece.size()) {
            const uint64_t count = std::min<uint64_t>(piece.size(), parts[i].bytes - done);
            read(parts_[i].offset + done, piece.data(), count);
            parts[i].write(piece.data(), done, count);
        }
    }
    solver.restore(state_);
}

} // namespace relume
