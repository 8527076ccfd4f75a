// Photographs without a target, cut and scaled to the camera's size.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "host_sim/render/random.hpp"
#include "host_sim/render/render.hpp"

namespace berth::host {

/// All photographs of a folder and its subfolders, read when first wanted. Usable from several
/// threads at once; copies share the pictures.
class PhotoLibrary {
 public:
  /// The error is one line: what is missing and what to install.
  static tl::expected<PhotoLibrary, std::string> open(const std::string& folder);

  int count() const;

  /// A part of a photograph, between a sixth of its shorter side and all of it, turned by quarters
  /// and mirrored, its contrast changed and sensor noise added.
  Image8 crop(int width, int height, Random& random) const;

 private:
  struct Pictures;
  explicit PhotoLibrary(std::shared_ptr<Pictures> pictures) : pictures_(std::move(pictures)) {}
  std::shared_ptr<Pictures> pictures_;
};

}  // namespace berth::host
