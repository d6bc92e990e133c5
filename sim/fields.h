// Named fields of plain structs: how profiles, counters and shader constants are read, written and recorded by name.
//
// A struct takes part by saying   static constexpr auto fields() { return std::tuple{Field{"name", &T::name}, ...}; }
#pragma once

#include <string_view>
#include <tuple>

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
