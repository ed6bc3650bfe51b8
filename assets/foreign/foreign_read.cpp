#include "assets/foreign/foreign_read.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/smoothing_groups.h"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <vector>

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/ProgressHandler.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <fmt/format.h>

namespace relume::foreign {
namespace {

// These are parts that no scene here has.
constexpr int kRemoved =
    aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS | aiComponent_TANGENTS_AND_BITANGENTS;

// Returns a stream without the mark that some editors put before UTF-8 (EF BB BF): libassimp takes it for the
// beginning of an .obj file's first word. `stream` is at its beginning.
std::unique_ptr<Assimp::IOStream> withoutMark(std::unique_ptr<Assimp::IOStream> stream) {
    constexpr std::array<uint8_t, 3> kMark = {0xEF, 0xBB, 0xBF};
    std::array<uint8_t, 3> begin{};
    const size_t size = stream->FileSize();
    if (size >= kMark.size() && stream->Read(begin.data(), 1, begin.size()) == begin.size() &&
        begin == kMark) {
        auto rest = std::make_unique<uint8_t[]>(size - kMark.size());
        const size_t count = stream->Read(rest.get(), 1, size - kMark.size());
        return std::make_unique<Assimp::MemoryIOStream>(rest.release(), count, true);
    }
    stream->Seek(0, aiOrigin_SET);
    return stream;
}

/// Opens the file itself, and of all others those that NearFiles finds; for reading alone. It has libassimp's
/// own system open them, from which newer versions let nobody derive.
class NearSystem final : public Assimp::IOSystem {
public:
    /// Appends the names of material libraries that are looked for and not found.
    NearSystem(std::string model, NearFiles& near, std::vector<std::string>& missingLibraries)
        : model_(std::move(model)), near_(near), missingLibraries_(missingLibraries) {}

    bool Exists(const char* file) const override { return !pathOf(file).empty(); }
    char getOsSeparator() const override { return files_.getOsSeparator(); }
    void Close(Assimp::IOStream* stream) override { files_.Close(stream); }
    bool ComparePaths(const char* one, const char* second) const override {
        return files_.ComparePaths(one, second);
    }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        const std::string path = pathOf(file);
        if (path.empty() && lowerEnding(file) == ".mtl")
            missingLibraries_.push_back(std::filesystem::path(file).filename().string());
        if (path.empty() || std::string(mode).find_first_of("wa+") != std::string::npos) return nullptr;
        std::unique_ptr<Assimp::IOStream> stream(files_.Open(path.c_str(), mode));
        const std::string ending = lowerEnding(file);
        if (stream && (ending == ".obj" || ending == ".mtl")) stream = withoutMark(std::move(stream));
        return stream.release();
    }

private:
    std::string pathOf(const std::string& file) const { return file == model_ ? file : near_.find(file); }

    Assimp::DefaultIOSystem files_;
    std::string model_;
    NearFiles& near_;
    std::vector<std::string>& missingLibraries_;
};

class Progress final : public Assimp::ProgressHandler {
public:
    explicit Progress(ForeignProgress progress) : progress_(std::move(progress)) {}
    bool Update(float done) override {
        if (progress_) progress_(done);
        return true;
    }

private:
    ForeignProgress progress_;
};

/// Tells what a reader of libassimp may get wrong at a damaged file, before other parts of it rely on that.
std::string damageOf(const aiScene& scene) {
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
        const aiMesh* mesh = scene.mMeshes[i];
        if (!mesh || (mesh->mNumFaces > 0 && !mesh->mFaces)) return "a mesh is missing";
        for (unsigned f = 0; f < mesh->mNumFaces; ++f) {
            const aiFace& face = mesh->mFaces[f];
            if (face.mNumIndices > 0 && !face.mIndices) return "a face has no corners";
            for (unsigned k = 0; k < face.mNumIndices; ++k)
                if (face.mIndices[k] >= mesh->mNumVertices) return "a face names a vertex that is not there";
        }
    }
    std::vector<const aiNode*> open = {scene.mRootNode};
    while (!open.empty()) {
        const aiNode* node = open.back();
        open.pop_back();
        if (!node) return "a node is missing";
        for (unsigned i = 0; i < node->mNumMeshes; ++i)
            if (node->mMeshes[i] >= scene.mNumMeshes) return "a node names a mesh that is not there";
        open.insert(open.end(), node->mChildren, node->mChildren + node->mNumChildren);
    }
    return "";
}

bool hasPoints(const aiScene& scene) {
    return std::any_of(scene.mMeshes, scene.mMeshes + scene.mNumMeshes, [](const aiMesh* mesh) {
        return mesh->mPrimitiveTypes & (aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    });
}

std::string oneLine(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

} // namespace

Reader::Reader(NearFiles& near, const ForeignProgress& progress) : near_(near) {
    importer_.SetProgressHandler(new Progress(progress)); // which the importer deletes
    configure();
}

void Reader::configure() {
    importer_.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kRemoved);
    // Files that hold but bones would get a mesh that shows them.
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
#ifdef AI_CONFIG_IMPORT_FBX_IGNORE_UP_AXIS_DIRECTION
    // Newer releases of libassimp would turn .fbx files themselves, as older ones do not: see toMetres().
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_FBX_IGNORE_UP_AXIS_DIRECTION, true);
#endif
}

// Tells why libassimp gave up. Its own words may be several lines.
void Reader::fail(const std::string& path) const {
    if (const std::exception_ptr cause = importer_.GetException()) {
        try {
            std::rethrow_exception(cause);
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception&) { // its text is the one below
        }
    }
    throw Error(fmt::format("{}: cannot be read ({}): {}", path,
                            inQuotes(oneLine(importer_.GetErrorString())), mendOf(path)));
}

// libassimp looks for a library under the model's own name, too, where it does not find the one that is
// named. The file wants for nothing where that is there, and names it itself where it looked for no other.
void Reader::keepNamedLibraries(const std::string& path) {
    std::vector<std::string>& names = missingLibraries_;
    const std::string own = std::filesystem::path(path).filename().replace_extension("mtl").string();
    if (std::find(names.begin(), names.end(), own) == names.end()) names.clear();
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    if (names.size() > 1) names.erase(std::find(names.begin(), names.end(), own));
}

const aiScene& Reader::read(const std::string& path) {
    if (!meansItsNormals(path))
        importer_.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kRemoved | aiComponent_NORMALS);
    importer_.SetIOHandler(new NearSystem(path, near_, missingLibraries_)); // which the importer deletes
    const aiScene* scene = importer_.ReadFile(path, 0);
    if (!scene) fail(path);
    keepNamedLibraries(path);
    if (const std::string damage = damageOf(*scene); !damage.empty())
        throw Error(fmt::format("{}: is damaged ({}): export it again", path, damage));
    skippedPoints_ = hasPoints(*scene);
    animated_ = scene->mNumAnimations > 0;
    skinned_ = std::any_of(scene->mMeshes, scene->mMeshes + scene->mNumMeshes,
                           [](const aiMesh* mesh) { return mesh->mNumBones > 0; });
    // No normals are made here: libassimp smooths over points that are merely close to each other.
    scene = importer_.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_Triangulate |
                                          aiProcess_GenUVCoords | aiProcess_TransformUVCoords);
    if (!scene) fail(path);
    return *scene;
}

} // namespace relume::foreign
