// sampledb/http/certificates.h: where this system keeps the certificates of the authorities that web servers are known by.
#pragma once

#include <unistd.h>

#include <array>
#include <cstdlib>

namespace latent::sampledb {

// libcurl knows the place of the system that it was built for, which a bundle leaves. Null: none is found; then libcurl's own.
// $SSL_CERT_FILE is first, as it is for OpenSSL.
inline const char* certificate_file() {
    constexpr std::array kPlaces = {
        "/etc/ssl/certs/ca-certificates.crt",  // Debian, Ubuntu, Arch, Gentoo
        "/etc/pki/tls/certs/ca-bundle.crt",    // Fedora, Red Hat
        "/etc/ssl/ca-bundle.pem",              // openSUSE
        "/etc/ssl/cert.pem",                   // Alpine
    };
    if (const char* const named = std::getenv("SSL_CERT_FILE"); named != nullptr && *named != '\0') return named;
    for (const char* const place : kPlaces) {
        if (::access(place, R_OK) == 0) return place;
    }
    return nullptr;
}

}  // namespace latent::sampledb
