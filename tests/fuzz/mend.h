// tests/fuzz/mend.h: the checksums of a .latent file whose bytes were changed, made right again. docs/format.md.
#pragma once

#include "base/bytes.h"

namespace latent::fuzz {

void mend_header(Bytes& file);                // both copies, each by itself
void mend_run(Bytes& bytes, std::size_t at);  // the run that begins there: its pages, index and header
void mend_footer(Bytes& file);
void mend_file(Bytes& file);  // all of these

}  // namespace latent::fuzz
