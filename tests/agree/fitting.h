// A profile while it is fitted: fields with where their values have come from. Internal to fit*.cpp.
#pragma once

#include "tests/agree/fit.h"

#include <type_traits>

namespace gnomon::agree {

class Fitting {
public:
    explicit Fitting(const Measurements& measurements);

    template <class Value>
    void set(Value Profile::* member, std::type_identity_t<Value> value, std::string text, Basis basis = Basis::Measured) {
        fitted.profile.*member = value;
        note(member, basis, std::move(text));
    }
    /// The value stays; why it is not determined.
    template <class Value>
    void keep(Value Profile::* member, std::string text) {
        note(member, Basis::Assumed, std::move(text));
    }

    const Measurements& seen;
    FittedProfile fitted{};

private:
    template <class Value>
    void note(Value Profile::* member, Basis basis, std::string text) {
        std::size_t place = 0;
        const auto try_field = [&](const auto& field) {
            if constexpr (std::is_same_v<decltype(field.member), Value Profile::*>)
                if (field.member == member) fitted.evidence[place - 2] = {std::string(field.name), basis, std::move(text)};
            ++place;
        };
        std::apply([&](const auto&... field) { (try_field(field), ...); }, Profile::fields());
    }
};

void fit_texels(Fitting& fit);
void fit_levels(Fitting& fit);      // after fit_texels
void fit_anisotropy(Fitting& fit);  // after fit_levels

/// log2 of `texels` as a model has it.
double model_log2(double texels, Log2Model model);
/// A level of detail at the precision that `profile` has so far.
double stored_lod(double lod, const Profile& profile);

}  // namespace gnomon::agree
