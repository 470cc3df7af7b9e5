// sampledb/http/module.h: what the module latent_http.so is asked for.
#pragma once

#include <memory>
#include <string>

#include "sampledb/read/byte_source.h"

// The version of Latent that the module was built with: other programs would not understand its sources.
extern "C" __attribute__((visibility("default"))) const char* latent_http_version();

// Opens a file on a web server. All sources of a program share one cache. Errors, in `status`: those of HttpSource::open.
extern "C" __attribute__((visibility("default"))) void latent_open_http(const std::string& url,
                                                                        std::shared_ptr<const latent::sampledb::ByteSource>& source,
                                                                        latent::Status& status);
