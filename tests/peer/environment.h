// What must be said to Vulkan drivers before the first instance exists: which ones to load, and how many threads to take.
#pragma once

#include <string>
#include <vector>

namespace gnomon::peer {

/// The manifests (*.json) of the drivers installed here: the loader's standard folders, then the SwiftShader that Chromium
/// brings, which stands in none of them. Sorted within each folder; only files that exist.
std::vector<std::string> driver_manifests();

/// Lets one instance see all of driver_manifests(), by VK_DRIVER_FILES and its older name VK_ICD_FILENAMES; where the user has
/// set either, nothing changes. Call it before the first list_devices(), while the process has one thread.
void expose_drivers();

/// Holds the software devices to `threads` threads: llvmpipe by LP_NUM_THREADS, SwiftShader, which takes one per processor, by
/// the processors that the calling thread (and every thread started from it, ours and the drivers') may run on. Call it first
/// of all. Throws Error when `threads` is not positive; asks no more processors than there are.
void limit_threads(int threads);

}  // namespace gnomon::peer
