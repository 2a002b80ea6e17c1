/* Fuzzes msn_decode(): LLVMFuzzerTestOneInput for libFuzzer, or with -DSTANDALONE a main of its own that mutates the
 * corpus: packet_fuzz COUNT SEED LINE. Each packet that the decoder returns must be in the input, framed, with
 * its checksum: an independent encoder here builds the frame again and compares it with the input. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "msn_packet.h"

static uint32_t crc(const uint8_t *data, size_t length) {
  uint32_t sum = ~0u;
  for (size_t i = 0; i < length; i++) {
    for (int bit = 0; bit < 8; bit++) {
      sum = (sum >> 1) ^ (((sum ^ (uint32_t)(data[i] >> bit)) & 1) ? 0xedb88320u : 0);
    }
  }
  return ~sum;
}

/* The frame that the packet must have had, stuffed and ended by 0; returns its length. */
static size_t frame_of(const struct msn_packet *p, uint8_t *out) {
  uint8_t body[512];
  size_t length = 0, since = 0;
  body[length++] = p->type;
  body[length++] = p->number;
  for (int i = 0; i < 6; i++) body[length++] = (uint8_t)(p->time >> 8 * i);
  memcpy(body + length, p->payload, p->length);
  length += p->length;
  const uint32_t sum = crc(body, length);
  for (int i = 0; i < 4; i++) body[length++] = (uint8_t)(sum >> 8 * i);
  for (size_t i = 0; i <= length; i++) { /* a zero, and the end, become the distance to the previous zero */
    since++;
    out[i] = i < length && body[i] ? body[i] : (uint8_t)since;
    if (i == length || !body[i]) since = 0;
  }
  out[length + 1] = 0;
  return length + 2;
}

static unsigned long found;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  struct msn_decoder *decoder = calloc(1, sizeof *decoder); /* on the heap, so that sanitizers see an overrun */
  struct msn_packet packet;
  size_t begin = 0;
  for (size_t i = 0; i < size; i++) {
    if (msn_decode(decoder, data[i], &packet)) {
      uint8_t frame[600];
      const size_t length = frame_of(&packet, frame);
      found++;
      if (length != i + 1 - begin || memcmp(frame, data + begin, length)) {
        fprintf(stderr, "a packet that was not sent\n");
        abort();
      }
    }
    if (!data[i]) begin = i + 1;
  }
  free(decoder);
  return 0;
}

#ifdef STANDALONE
static uint64_t state;

static uint32_t draw(uint32_t below) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (uint32_t)(state >> 16) % below;
}

int main(int argc, char **argv) {
  static uint8_t line[1 << 16], made[1 << 16];
  if (argc != 4) return 2;
  FILE *file = fopen(argv[3], "rb");
  if (!file) return 2;
  const uint32_t whole = (uint32_t)fread(line, 1, sizeof line, file);
  fclose(file);
  if (whole == 0) return 2;
  const unsigned long count = strtoul(argv[1], NULL, 10);
  state = strtoull(argv[2], NULL, 10) * 0x9e3779b97f4a7c15u + 1;
  for (unsigned long n = 0; n < count; n++) {
    uint32_t length;
    if (n % 2) {
      length = draw(600);
      for (uint32_t i = 0; i < length; i++) made[i] = (uint8_t)draw(n % 4 == 1 ? 256 : 3);
    } else {
      const uint32_t begin = draw(whole);
      length = n % 8 ? 1 + draw(120) : whole;
      if (length > whole - begin) length = whole - begin;
      memcpy(made, line + begin, length);
      for (uint32_t changes = draw(4); changes > 0 && length > 0; changes--) {
        const uint32_t at = draw(length), kind = draw(4);
        if (kind == 0) made[at] = (uint8_t)(made[at] ^ 1 << draw(8));
        if (kind == 1) memmove(made + at + 1, made + at, length++ - at), made[at] = (uint8_t)draw(256);
        if (kind == 2) memmove(made + at, made + at + 1, --length - at);
        if (kind == 3) made[at] = 0;
      }
    }
    LLVMFuzzerTestOneInput(made, length);
  }
  printf("%lu strings, %lu packets, all as sent\n", count, found);
  return 0;
}
#endif
