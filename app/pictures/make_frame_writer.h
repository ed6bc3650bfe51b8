#pragma once

#include <memory>

#include "app/pictures/frame_writer.h"

namespace relume {

/// Throws Error where writing is sure to fail: before the bake, which would be in vain. Changes nothing yet.
std::unique_ptr<FrameWriter> makeFrameWriter(const FrameWriter::Desc& desc);

} // namespace relume
