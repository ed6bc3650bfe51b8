#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "renderer/camera.h"
#include "renderer/draw_settings.h"

namespace relume {

constexpr uint32_t kLeastWindowEdge = 320, kMostWindowEdge = 16384; // [screen coordinates]

/// A camera that the user wants to come back to.
struct Bookmark {
    std::string name;
    ViewCamera camera;
};

/// The settings that stay from one run of the viewer to the next.
struct Preferences {
    static constexpr size_t kMostRecent = 12;

    std::vector<std::string> recent;                        // scenes, absolute paths, the newest first
    std::map<std::string, std::vector<Bookmark>> bookmarks; // by a scene's absolute path
    uint32_t width = 1280, height = 800;                    // of the window [screen coordinates] at scale 1
    float panelWidth = 340;                                 // [screen coordinates] at scale 1
    float uiScale = 1;                                      // beside the monitor's own scale
    bool vsync = true, caption = false;
    std::optional<uint32_t> samples; // of each pixel; none: what suits the device
    LightmapFilter filter = LightmapFilter::Bilinear;
    ToneMap tone = ToneMap::Agx;
    std::string captureFolder; // "": defaultCaptureFolder()

    void addRecent(const std::string& path);
    /// Does the same with a path that is absolute.
    void pushRecent(const std::string& path);
    /// Keeps a camera for a scene, and returns its name, which no other of that scene has.
    std::string addBookmark(const std::string& scene, const ViewCamera& camera);
};

/// Returns the size by which a window of so many pixels is asked for again [screen coordinates at scale 1]. A
/// window is made larger by its monitor's scale, which its pixels have already. A tiny one is remembered as
/// the smallest that the file may hold.
glm::uvec2 rememberedWindow(const glm::uvec2& pixels, float contentScale);

/// Returns the path by which bookmarks of a scene are kept.
std::string absolutePath(const std::string& path);

/// Returns $XDG_CONFIG_HOME/relume/preferences.json, or the same in ~/.config; "" where there is neither.
std::string preferencesPath();
/// Returns ~/Pictures/relume where there is a ~/Pictures, else the working folder.
std::string defaultCaptureFolder();

/// Reads the file. What is missing or wrong in it keeps its default, with one warning; where there is no
/// file, everything does, without a warning.
Preferences readPreferences(const std::string& path);
/// Returns the same; nothing where there is no file, or one that is no JSON object, which is warned about.
std::optional<Preferences> findPreferences(const std::string& path);
/// Writes the file, and makes its folder. Throws Error.
void writePreferences(const std::string& path, const Preferences& preferences);

} // namespace relume
