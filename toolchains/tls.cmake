# mbedTLS 2.28 for encrypted links: sets POCKETRAY_HAVE_TLS, POCKETRAY_MBEDTLS (libraries) and MBEDTLS_INCLUDE. Debian's library
# calls calloc() and free(); in a copy of its archives these become functions of ours, which take memory from the link's own
# (platform/net/tls/tls_heap.h), as nothing allocates after the start.
set(POCKETRAY_HAVE_TLS OFF)
set(tls_missing)
string(TOUPPER "${POCKETRAY_TLS}" tls_wanted)
if(NOT POCKETRAY_NETWORK)
  set(tls_missing "a build without a network needs none")
elseif(NOT tls_wanted STREQUAL "AUTO" AND NOT POCKETRAY_TLS)
  set(tls_missing "POCKETRAY_TLS is ${POCKETRAY_TLS}")
else()
  find_path(MBEDTLS_INCLUDE mbedtls/ssl.h)
  find_library(MBEDTLS_TLS libmbedtls.a)
  find_library(MBEDTLS_X509 libmbedx509.a)
  find_library(MBEDTLS_CRYPTO libmbedcrypto.a)
  if(NOT MBEDTLS_INCLUDE OR NOT MBEDTLS_TLS OR NOT MBEDTLS_X509 OR NOT MBEDTLS_CRYPTO)
    set(tls_missing "no mbedTLS (Debian: libmbedtls-dev)")
  elseif(NOT CMAKE_OBJCOPY)
    set(tls_missing "no objcopy")
  else()
    set(CMAKE_REQUIRED_INCLUDES ${MBEDTLS_INCLUDE})
    set(CMAKE_REQUIRED_LIBRARIES ${MBEDTLS_TLS} ${MBEDTLS_X509} ${MBEDTLS_CRYPTO})
    check_cxx_source_compiles("#include <mbedtls/ssl.h>
      #include <mbedtls/version.h>
      #if MBEDTLS_VERSION_NUMBER < 0x021C0000 || MBEDTLS_VERSION_NUMBER >= 0x03000000
      #error version
      #endif
      #if !defined MBEDTLS_KEY_EXCHANGE_ECDHE_PSK_ENABLED || !defined MBEDTLS_CHACHAPOLY_C || !defined MBEDTLS_ECP_DP_CURVE25519_ENABLED
      #error parts
      #endif
      int main() { mbedtls_ssl_context ssl; mbedtls_ssl_init(&ssl); return mbedtls_ssl_handshake(&ssl); }" POCKETRAY_MBEDTLS_FITS)
    unset(CMAKE_REQUIRED_INCLUDES)
    unset(CMAKE_REQUIRED_LIBRARIES)
    if(NOT POCKETRAY_MBEDTLS_FITS)
      set(tls_missing "${MBEDTLS_TLS} is not mbedTLS 2.28 with ECDHE-PSK, ChaCha20-Poly1305 and Curve25519 for this CPU")
    endif()
  endif()
endif()
if(NOT tls_missing)
  set(POCKETRAY_HAVE_TLS ON)
  set(POCKETRAY_MBEDTLS)
  foreach(part TLS X509 CRYPTO)
    get_filename_component(name ${MBEDTLS_${part}} NAME_WE)
    set(copy ${CMAKE_CURRENT_BINARY_DIR}/mbedtls/${name}_pocketray.a)
    file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/mbedtls)
    execute_process(COMMAND ${CMAKE_OBJCOPY} --redefine-sym calloc=pocketray_tls_calloc --redefine-sym free=pocketray_tls_free
      ${MBEDTLS_${part}} ${copy} RESULT_VARIABLE objcopy_status)
    if(objcopy_status)
      message(FATAL_ERROR "${CMAKE_OBJCOPY} cannot copy ${MBEDTLS_${part}}: build with -DPOCKETRAY_TLS=OFF")
    endif()
    list(APPEND POCKETRAY_MBEDTLS ${copy})
  endforeach()
elseif(tls_wanted STREQUAL "AUTO" OR NOT POCKETRAY_TLS)
  message(STATUS "no TLS: ${tls_missing}")
else()
  message(FATAL_ERROR "POCKETRAY_TLS is ON, but ${tls_missing}")
endif()
