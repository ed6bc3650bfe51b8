#pragma once

#include <string>

#include <glm/glm.hpp>

#include "app/viewer/state/bake_badge.h"
#include "app/viewer/state/picture_area.h"

namespace relume {

/// Returns the margin around text over the scene [screen coordinates].
float labelMargin();
/// Returns the width of a label's text [screen coordinates].
float labelWidth(const char* text);
/// Draws text on a dark ground behind the windows of Dear ImGui, its upper left corner at `at`.
void drawLabel(const glm::vec2& at, const char* text, const glm::vec4& color);
/// Draws how far the light is, in the lower right corner of the picture, and above it what the level was
/// furnished with, "" for nothing.
void drawBadge(const BakeBadge& badge, const std::string& furnished, const PictureArea& area);

} // namespace relume
