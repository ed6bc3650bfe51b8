#pragma once

#include <string>
#include <vector>

#include "assets/images/float_image.h"

namespace relume {

/// Returns why no page can be opened here: node, Chromium or npm packages are missing; "": one can.
std::string whyNoPages();

/// Opens a page of a folder in headless Chromium, as show.mjs does, and returns its picture in linear light,
/// decoded by the exact curve of sRGB. Fails the running test where the page does not get ready or logs an
/// error.
FloatImage pictureOfPage(const std::string& folder, const std::string& page, uint32_t width, uint32_t height);

/// Runs gltf-validator on GLB files. Returns one line for each error and warning.
std::string complaintsAbout(const std::vector<std::string>& files);

} // namespace relume
