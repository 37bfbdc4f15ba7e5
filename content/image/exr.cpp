#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <fmt/format.h>

#include "content/error.h"
#include "content/image/image.h"
#include "content/image/temporary_file.h"

namespace probewalk {

void write_exr(const std::filesystem::path& file, int width_px, int height_px,
               const std::vector<ExrChannel>& channels) {
  const std::size_t pixels = width_px > 0 && height_px > 0 ? static_cast<std::size_t>(width_px) * height_px : 0;
  for (const ExrChannel& channel : channels) {
    if (pixels == 0 || channel.values.size() != pixels) {
      throw BadInput(fmt::format("{}: channel {} has {} values for {} x {} pixels", file.string(), channel.name,
                                 channel.values.size(), width_px, height_px));
    }
  }
  TemporaryFile temporary(file);
  try {
    Imf::Header header(width_px, height_px);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frame;
    for (const ExrChannel& channel : channels) {
      header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
      // OpenEXR wants a pointer it may write to, and only reads through it here.
      char* base = const_cast<char*>(reinterpret_cast<const char*>(channel.values.data()));
      frame.insert(channel.name, Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * width_px));
    }
    Imf::OutputFile output(temporary.path().c_str(), header, 0);
    output.setFrameBuffer(frame);
    output.writePixels(height_px);
  } catch (const std::exception& error) {
    throw BadInput(fmt::format("{}: cannot be written ({})", file.string(), error.what()));
  }
  temporary.commit();
}

}  // namespace probewalk
