// All memory that the chain needs beside the frame: the caller owns it, once, statically.
#pragma once

namespace berth {

struct Workspace {
  int placeholder = 0;
};

}  // namespace berth
