#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/images/image_file.h"
#include "assets/images/layered_exr.h"
#include "assets/model/lightmap_pages.h"

namespace relume {

// A lightmap of several pages is one image in memory, the sheet on which they lie side by side
// (lightmap_pages.h), whose attributes say how many there are. As files it is NAME.0.exr, NAME.1.exr and so
// on, each of which says which page of how many it is and what lightmap it belongs to. The functions below
// take and return the sheet, and the name without a number. A lightmap of one page is one file of that name.

/// Notes in an image of how many pages it is the sheet.
void noteLightmapPages(FloatImage& image, const LightmapPages& pages);
/// Returns what was noted; one page where nothing was.
LightmapPages lightmapPagesOf(const FloatImage& image);

/// Returns the name of a page's file: "room.exr" and 2 give "room.2.exr".
std::string pagePath(const std::string& path, uint32_t page);
/// Returns the files of a lightmap that is written to `path`.
std::vector<std::string> lightmapFiles(const std::string& path, const LightmapPages& pages);

/// Returns what somebody is to be told whose light a .png cuts off, as it holds none above 1; "" where that
/// is less than a hundredth of the texels of surfaces, or where `path` ends otherwise.
std::string lostInPng(const std::string& path, const FloatImage& image);
/// Writes an image as writeImage does, with a warning where a .png loses light, each page into a file of its
/// own; no page takes its name before all are whole.
void writeLightmap(const std::string& path, const FloatImage& image, ExrType type = ExrType::Float,
                   ExrCompression compression = kExrCompression);
/// Does the same for a .png beside a file that holds all light, so that nothing is lost and told.
void writeLightmapPicture(const std::string& path, const FloatImage& image);
/// Does what writeLightmap does with layers, as writeLayeredExr does.
void writeLayeredLightmap(const std::string& path, const LayeredImage& image, ExrType type = ExrType::Float,
                          ExrCompression compression = kExrCompression);

/// Reads an image of any kind, or all pages of a lightmap. Throws Error where a page is missing, pages differ
/// in size or channels or belong to several lightmaps, where `path` names a single page, and where there is
/// both an image of this name and pages.
FloatImage readLightmapFile(const std::string& path, uint64_t mostPixels = kMostImagePixels);
/// Does the same, but a single page may be named, too, and is an image by itself.
FloatImage readImageOrPages(const std::string& path);
/// Does what readLightmapFile does with layers, as readLayeredExr does.
LayeredImage readLayeredLightmap(const std::string& path);

/// Returns the files that reading `path` reads: those of its pages, or itself.
std::vector<std::string> filesOfLightmap(const std::string& path);

/// Returns a page of a sheet, with the attributes of its file; the sheet of `pages`, page by page.
FloatImage pageOf(const FloatImage& sheet, uint32_t page);
FloatImage sheetOf(const std::vector<FloatImage>& pages, const LightmapPages& layout);

} // namespace relume
