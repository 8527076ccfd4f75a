// Every static buffer of the firmware, in one place: who uses it, its section and its size
// (docs/memory.md has the table, made from the linked image).
#pragma once

#include "app/application.hpp"

namespace berth::storage {

/// The application's memory, made of the buffers in storage.cpp.
ApplicationMemory application_memory();

}  // namespace berth::storage
