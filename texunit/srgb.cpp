#include "texunit/srgb.h"

#include "sim/scalar_math.h"

#include <limits>

namespace gnomon {

const SrgbTables& srgb_tables() {
    static const SrgbTables tables = [] {
        const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : scalar::pow((c + 0.055) / 1.055, 2.4); };
        SrgbTables t{};
        for (std::size_t code = 0; code < 256; ++code) {
            t.linear[code] = code == 255 ? 1.0 : linear(static_cast<double>(code) / 255.0);
            t.linear_bits[code] = std::bit_cast<std::int32_t>(static_cast<float>(t.linear[code]));
            if (code == 0) continue;

            // 3.2.3.8 has its own branch point, in linear space: invert what it does, not what 3.2.3.7 does.
            const double encoded = (static_cast<double>(code) - 0.5) / 255.0;
            const double curved = scalar::pow((encoded + 0.055) / 1.055, 2.4);
            t.threshold[code] = curved <= 0.0031308 ? encoded / 12.92 : curved;
            float above = static_cast<float>(t.threshold[code]);
            if (static_cast<double>(above) < t.threshold[code])
                above = std::nextafter(above, std::numeric_limits<float>::infinity());
            t.threshold_bits[code] = std::bit_cast<std::int32_t>(above);
        }
        return t;
    }();
    return tables;
}

}  // namespace gnomon
