// Finds accesses that make a dispatch depend on the order of its threads: what compute.h asks of functors, verified word by
// word. D3D11.3 7.14
#pragma once

#include "sim/error.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>

namespace gnomon {

enum class MemoryAccess { Read, Write, Atomic };

/// One dispatch's memory. Groups are told one after the other, and so are the blocks between two barriers of a group.
class RaceCheck {
public:
    struct Touch {
        MemoryAccess access;
        bool is_shared;  // memory of the group under way, not of the device
    };

    explicit RaceCheck(std::string_view label) : label_(label) {}

    void begin_group() {
        ++group_;
        shared_.clear();
    }
    void begin_block() { ++block_; }

    /// A thread of the group under way touches a word. Throws Error where another thread of the same block, or of another
    /// group, touched it in a way that leaves the result to their order. `describe()` names the word.
    template <class Describe>
    void admit(const void* address, const Touch& touch, int thread, const Describe& describe) {
        Word& word = (touch.is_shared ? shared_ : device_)[address];
        if (word.block != block_) {
            word.block = block_;
            word.threads = {};
        }
        if (!word.threads.admit(thread, touch.access))
            fail("dispatch '{}': {} is touched by two threads of one group between barriers, and not only to read", label_,
                 describe());
        if (!word.groups.admit(group_, touch.access))
            fail("dispatch '{}': {} is touched by two groups, and not only to read", label_, describe());
    }

private:
    /// Who touched a word in each way: nobody, one, or several.
    struct Users {
        static constexpr int kNobody = -1;
        static constexpr int kSeveral = -2;
        int reader = kNobody;
        int writer = kNobody;
        int atomic = kNobody;

        /// Whether what everybody did so far and this have one outcome in any order.
        bool admit(int who, MemoryAccess access) {
            const auto others = [who](int user) { return user != kNobody && user != who; };
            bool clashes = others(writer);
            if (access != MemoryAccess::Read) clashes = clashes || others(reader);
            if (access != MemoryAccess::Atomic) clashes = clashes || others(atomic);
            int& user = access == MemoryAccess::Read ? reader : access == MemoryAccess::Write ? writer : atomic;
            user = others(user) ? kSeveral : who;
            return !clashes;
        }
    };
    struct Word {
        std::uint64_t block = 0;
        Users threads;  // of the block
        Users groups;
    };

    std::string label_;
    std::unordered_map<const void*, Word> device_;
    std::unordered_map<const void*, Word> shared_;
    int group_ = -1;
    std::uint64_t block_ = 0;
};

}  // namespace gnomon
