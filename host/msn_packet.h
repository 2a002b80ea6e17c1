/* SPDX-License-Identifier: Apache-2.0
 * Decodes the packets of a Meissner core from the bytes of its serial line (docs/link.md). C99, allocates no memory.
 *
 *   static struct msn_decoder decoder;          initial state: all zeros
 *   struct msn_packet packet;
 *   if (msn_decode(&decoder, byte, &packet)) switch (packet.type) { ... }
 */
#ifndef MSN_PACKET_H
#define MSN_PACKET_H

#include <stddef.h>
#include <stdint.h>

#define MSN_MAX_PACKET 253
#define MSN_MAX_TAXELS 116

#define MSN_MAX_STATES 128

enum {
  MSN_SLIP = 1, /* a slip begins */
  MSN_COP = 2,
  MSN_IMAGE = 3,
  MSN_HEALTH = 4,
  MSN_STATISTIC = 5,
  MSN_CHANGE = 6, /* any other change of a channel's state */
  MSN_STATES = 7, /* the states of channels, asked for by register link.states */
  MSN_CLASS = 8,  /* the forest decides for another class */
  MSN_ANSWER = 16
};

/* The state of a channel. A change from incipient or gross to contact is the end of a slip. */
enum { MSN_NONE = 0, MSN_CONTACT = 1, MSN_INCIPIENT = 2, MSN_GROSS = 3, MSN_RELEASE = 4 };

struct msn_packet {
  uint8_t type;   /* for types not listed above, only payload is set */
  uint8_t number; /* mod 256 */
  uint64_t time;  /* clocks since reset, 48 bits */
  const uint8_t *payload; /* valid until the next byte is decoded */
  size_t length;
  union {
    struct { uint16_t channel; uint32_t p2p; uint8_t state; } slip;
    struct { uint16_t channel; uint32_t p2p; uint8_t state, told, late; } change; /* told: the state sent before */
    struct { uint16_t first, left, count; } states; /* of channels first .. first + count - 1: msn_state */
    struct { int32_t x, y; uint64_t load; uint8_t pressed; } cop; /* x, y: 16384 = 1.0 */
    struct { uint8_t image, last; uint32_t first; uint16_t count; } image; /* taxels: msn_taxel */
    struct { uint32_t taxel; uint8_t faults; } health;
    struct { uint8_t index; uint32_t value; } statistic;
    struct { uint16_t label, told; uint32_t votes; } classified; /* told: the class sent before; 65535: none */
    struct { uint8_t tag, status; uint16_t address; uint32_t data; } answer;
  } is;
};

struct msn_decoder {
  uint8_t frame[MSN_MAX_PACKET + 2];
  uint16_t length;
  uint8_t number, numbered;
  uint32_t damaged; /* frames that were not a valid packet */
  uint32_t missed;  /* packets missing by their numbers, each gap mod 256 */
};

/* Returns 1 if this byte completes a packet, which is then in *packet, else 0. */
int msn_decode(struct msn_decoder *decoder, uint8_t byte, struct msn_packet *packet);

/* Taxel `index`, 0 .. count - 1, of an image packet. */
uint16_t msn_taxel(const struct msn_packet *packet, size_t index);

/* State of channel first + `index`, 0 .. count - 1, of a packet of states. */
uint8_t msn_state(const struct msn_packet *packet, size_t index);

/* CRC-32 (ISO-HDLC) of `length` bytes. */
uint32_t msn_crc32(const uint8_t *bytes, size_t length);

#endif
