#include "assets/foreign/near_files.h"

#include "assets/base/uri.h"

#include <algorithm>
#include <cctype>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostParts = 32;      // of a path; what has more is no name of a picture
constexpr size_t kMostNames = 100'000; // read of one folder, whose listing would else take memory without end

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

fs::path folderOf(const std::string& model) {
    const fs::path folder = fs::path(model).parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

/// A name of a file as a model has it, taken apart.
struct Reference {
    std::vector<std::string> parts; // without "." and ".."
    size_t ups = 0;                 // how many folders it goes up first
    bool relative = true;
};

// Takes a name apart. It may be an URI, or a path of Windows.
Reference parse(std::string text) {
    std::replace(text.begin(), text.end(), '\\', '/');
    if (lowerCase(text.substr(0, 5)) == "file:") text.erase(0, 5);
    Reference reference;
    if (text.size() > 1 && text[1] == ':') {
        text.erase(0, 2);
        reference.relative = false;
    }
    if (text.starts_with("//")) // Blender's sign for the folder of the file
        text.erase(0, 2);
    else if (text.starts_with('/'))
        reference.relative = false;
    for (size_t begin = 0; begin <= text.size();) {
        const size_t end = std::min(text.find('/', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        begin = end + 1;
        if (part.empty() || part == ".") continue;
        if (part != "..")
            reference.parts.push_back(part);
        else if (!reference.parts.empty())
            reference.parts.pop_back();
        else
            ++reference.ups;
    }
    return reference;
}

// Returns a name without the blanks around it and without quotation marks, as exporters write both.
std::string bareName(std::string text) {
    const auto trim = [&] {
        const size_t first = text.find_first_not_of(" \t\r");
        text =
            first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
    };
    trim();
    if (text.size() > 1 && text.front() == text.back() && (text.front() == '"' || text.front() == '\'')) {
        text = text.substr(1, text.size() - 2);
        trim();
    }
    return text;
}

} // namespace

NearFiles::NearFiles(const std::string& model)
    : folder_(folderOf(model)), stem_(fs::path(model).stem().string()) {
    std::error_code code;
    outermost_ = fs::canonical(folder_, code);
    const fs::path parent = outermost_.parent_path();
    if (code || parent == outermost_.root_path()) return;
    above_ = folder_ / "..";
    outermost_ = parent;
}

std::string NearFiles::find(const std::string& reference) {
    for (const std::string& text : {reference, bareName(reference), decodedUri(reference)}) {
        if (text.find('\0') != std::string::npos) continue;
        const Reference name = parse(text);
        if (name.parts.empty() || name.parts.size() > kMostParts) continue;
        std::string found = findParts(name.parts, name.ups, name.relative);
        if (found.empty()) found = findUsual(name.parts.back());
        if (!found.empty()) return found;
    }
    return "";
}

std::string NearFiles::findParts(const Parts& parts, size_t ups, bool relative) {
    if (relative && ups == 1 && !above_.empty())
        if (std::string found = below(above_, parts); !found.empty()) return found;
    for (size_t first = 0; first < parts.size(); ++first)
        for (const fs::path& folder : {folder_, above_}) {
            if (folder.empty()) continue;
            if (std::string found = below(folder, parts, first); !found.empty()) return found;
        }
    return "";
}

std::string NearFiles::findUsual(const std::string& name) {
    for (const fs::path& folder : {folder_, above_}) {
        if (folder.empty()) continue;
        for (const std::string& usual :
             {std::string("textures"), std::string("texture"), std::string("tex"), std::string("maps"),
              std::string("images"), std::string("materials"), std::string("source"), stem_ + ".fbm", stem_})
            if (std::string found = below(folder, {usual, name}); !found.empty()) return found;
    }
    return "";
}

// Returns the regular file at the parts from `first` on below a folder; a part of another case will do where
// none is alike.
std::string NearFiles::below(const fs::path& folder, const Parts& parts, size_t first) {
    fs::path path = folder;
    for (size_t i = first; i < parts.size(); ++i) {
        const std::string name = entryOf(path, parts[i]);
        if (name.empty()) return "";
        path /= name;
    }
    std::error_code code;
    if (!fs::is_regular_file(path, code) || !isNear(path)) return "";
    return folder_ == "." ? path.lexically_normal().string() : path.string();
}

std::string NearFiles::entryOf(const fs::path& folder, const std::string& name) {
    std::error_code code;
    const auto [entry, isNew] = listings_.try_emplace(folder);
    std::vector<std::string>& names = entry->second;
    if (isNew) {
        if (!isNear(folder)) return "";
        for (fs::directory_iterator file(folder, code), end;
             !code && file != end && names.size() < kMostNames; file.increment(code))
            names.push_back(file->path().filename().string());
        std::sort(names.begin(), names.end());
    }
    if (std::binary_search(names.begin(), names.end(), name)) return name;
    const std::string wanted = lowerCase(name);
    const auto alike = std::find_if(names.begin(), names.end(),
                                    [&](const std::string& other) { return lowerCase(other) == wanted; });
    return alike == names.end() ? "" : *alike;
}

bool NearFiles::isNear(const fs::path& path) const {
    std::error_code code;
    const fs::path real = fs::canonical(path, code);
    if (code || outermost_.empty()) return false;
    return std::mismatch(outermost_.begin(), outermost_.end(), real.begin(), real.end()).first ==
           outermost_.end();
}

} // namespace relume
