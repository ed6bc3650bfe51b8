#pragma once

#include <memory>

#include "app/pictures/frame_writer.h"

namespace relume {

/// Throws UsageError where such a series cannot be wanted: by the path's ending, or as a video's size is odd.
void checkSeries(const FrameWriter::Desc& desc);

/// Makes the writer for a path, and changes nothing on the disk yet. Throws Error where writing is sure to
/// fail: before the bake, which would be in vain.
std::unique_ptr<FrameWriter> makeFrameWriter(const FrameWriter::Desc& desc);

} // namespace relume
