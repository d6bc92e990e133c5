// Named fields of plain structs: how profiles, counters and shader constants are read, written and recorded by name.
//
// A struct takes part by saying   static constexpr auto fields() { return std::tuple{Field{"name", &T::name}, ...}; }
#pragma once

#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

namespace gnomon {

template <class T, class Member>
struct Field {
    std::string_view name;
    Member T::* member;
};
template <class T, class Member>
Field(const char*, Member T::*) -> Field<T, Member>;

template <class T>
concept HasFields = requires { T::fields(); };

namespace detail {
/// Converts to a data member of any type of a T, but not to a base of it, whose members then count as its own. Never evaluated.
template <class T>
struct AnyMember {
    template <class Member>
        requires(!std::is_base_of_v<Member, T>)
    constexpr operator Member() const noexcept;
};
template <class T, std::size_t... kIndices>
constexpr bool takes_members(std::index_sequence<kIndices...>) {
    return requires { T{(static_cast<void>(kIndices), AnyMember<T>{})...}; };
}
/// The same behind an empty base.
template <class T, std::size_t... kIndices>
constexpr bool takes_members_behind_base(std::index_sequence<kIndices...>) {
    return requires { T{{}, (static_cast<void>(kIndices), AnyMember<T>{})...}; };
}
template <class T, std::size_t kCount = 0>
constexpr std::size_t member_count() {
    constexpr auto more = std::make_index_sequence<kCount + 1>{};
    if constexpr (takes_members<T>(more)) {
        return member_count<T, kCount + 1>();
    } else {
        return kCount;
    }
}
template <class T, std::size_t kCount = 0>
constexpr std::size_t member_count_behind_base() {
    constexpr auto more = std::make_index_sequence<kCount + 1>{};
    if constexpr (takes_members_behind_base<T>(more)) {
        return member_count_behind_base<T, kCount + 1>();
    } else {
        return kCount;
    }
}
}  // namespace detail

/// Whether fields() has every data member: what it leaves out nobody can check, record or show. Always true of classes with
/// constructors, whose members cannot be counted.
template <HasFields T>
constexpr bool names_every_member() {
    if constexpr (std::is_aggregate_v<T>) {
        constexpr std::size_t members = detail::member_count<T>();
        return std::tuple_size_v<decltype(T::fields())> == (members > 0 ? members : detail::member_count_behind_base<T>());
    } else {
        return true;
    }
}

/// Calls visit(name, value) for every field of `object`, in the order of declaration.
template <HasFields T, class Visit>
void for_each_field(T& object, const Visit& visit) {
    std::apply([&](const auto&... field) { (visit(field.name, object.*field.member), ...); }, T::fields());
}
template <HasFields T, class Visit>
void for_each_field(const T& object, const Visit& visit) {
    std::apply([&](const auto&... field) { (visit(field.name, object.*field.member), ...); }, T::fields());
}

}  // namespace gnomon
