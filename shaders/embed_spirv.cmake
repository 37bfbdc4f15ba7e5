# Writes OUT, a C++ file that defines probewalk::spirv::k_SYMBOL from the SPIR-V words of the file SPV.
file(READ ${SPV} hex HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1u," words "${hex}")
file(WRITE ${OUT} "#include <cstdint>\n#include <span>\nnamespace probewalk::spirv {\n"
  "namespace { const std::uint32_t words[] = {${words}}; }\n"
  "extern const std::span<const std::uint32_t> k_${SYMBOL};\n"
  "const std::span<const std::uint32_t> k_${SYMBOL}{words};\n}\n")
