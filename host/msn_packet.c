/* SPDX-License-Identifier: Apache-2.0 */
#include "msn_packet.h"

uint32_t msn_crc32(const uint8_t *bytes, size_t length) {
  uint32_t crc = 0xFFFFFFFFu;
  for (size_t i = 0; i < length; i++) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; bit++) crc = (crc >> 1) ^ ((crc & 1u) ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

/* The unsigned number in `count` bytes, lowest byte first. */
static uint64_t number_of(const uint8_t *bytes, int count) {
  uint64_t value = 0;
  while (count-- > 0) value = value << 8 | bytes[count];
  return value;
}

static int32_t signed24(const uint8_t *bytes) {
  int32_t value = (int32_t)number_of(bytes, 3);
  return value >= 0x800000 ? value - 0x1000000 : value;
}

uint16_t msn_taxel(const struct msn_packet *packet, size_t index) {
  return (uint16_t)number_of(packet->payload + 5 + 2 * index, 2);
}

uint8_t msn_state(const struct msn_packet *packet, size_t index) {
  return (uint8_t)(packet->payload[4 + index / 2] >> (index % 2 ? 4 : 0) & 7);
}

/* Restores the zeros in place: each code is the distance to the code before it. Returns 0 if the bytes are invalid. */
static int unstuff(uint8_t *frame, size_t length) {
  size_t place = length - 1, code = frame[place];
  while (code <= place) {
    place -= code;
    code = frame[place];
    frame[place] = 0;
  }
  return code == place + 1;
}

/* Decodes the payload's fields; returns 0 if its length is wrong for its type. */
static int fields(struct msn_packet *packet) {
  const uint8_t *b = packet->payload;
  size_t n = packet->length;
  switch (packet->type) {
    case MSN_SLIP:
      if (n != 6) return 0;
      packet->is.slip.channel = (uint16_t)number_of(b, 2);
      packet->is.slip.p2p = (uint32_t)number_of(b + 2, 3);
      packet->is.slip.state = b[5];
      return 1;
    case MSN_CHANGE:
      if (n != 6) return 0;
      packet->is.change.channel = (uint16_t)number_of(b, 2);
      packet->is.change.p2p = (uint32_t)number_of(b + 2, 3);
      packet->is.change.state = b[5] & 7;
      packet->is.change.told = b[5] >> 4 & 7;
      packet->is.change.late = b[5] >> 7;
      return 1;
    case MSN_STATES:
      if (n < 6) return 0;
      packet->is.states.first = (uint16_t)number_of(b, 2);
      packet->is.states.left = (uint16_t)number_of(b + 2, 2);
      packet->is.states.count =
          packet->is.states.left < MSN_MAX_STATES ? packet->is.states.left : MSN_MAX_STATES;
      return n == 4 + 2 * (((size_t)packet->is.states.count + 3) / 4);
    case MSN_COP:
      if (n != 12) return 0;
      packet->is.cop.x = signed24(b);
      packet->is.cop.y = signed24(b + 3);
      packet->is.cop.load = number_of(b + 6, 5);
      packet->is.cop.pressed = b[11] & 1;
      return 1;
    case MSN_IMAGE:
      if (n < 7 || n % 2 == 0) return 0;
      packet->is.image.image = b[0];
      packet->is.image.last = b[1] & 1;
      packet->is.image.first = (uint32_t)number_of(b + 2, 3);
      packet->is.image.count = (uint16_t)((n - 5) / 2);
      return 1;
    case MSN_HEALTH:
      if (n != 4) return 0;
      packet->is.health.taxel = (uint32_t)number_of(b, 3);
      packet->is.health.faults = b[3];
      return 1;
    case MSN_STATISTIC:
      if (n != 5) return 0;
      packet->is.statistic.index = b[0];
      packet->is.statistic.value = (uint32_t)number_of(b + 1, 4);
      return 1;
    case MSN_CLASS:
      if (n != 8) return 0;
      packet->is.classified.label = (uint16_t)number_of(b, 2);
      packet->is.classified.told = (uint16_t)number_of(b + 2, 2);
      packet->is.classified.votes = (uint32_t)number_of(b + 4, 4);
      return 1;
    case MSN_ANSWER:
      if (n != 8) return 0;
      packet->is.answer.tag = b[0];
      packet->is.answer.status = b[1];
      packet->is.answer.address = (uint16_t)number_of(b + 2, 2);
      packet->is.answer.data = (uint32_t)number_of(b + 4, 4);
      return 1;
    default:
      return 1;
  }
}

int msn_decode(struct msn_decoder *decoder, uint8_t byte, struct msn_packet *packet) {
  uint8_t *frame = decoder->frame;
  size_t length = decoder->length;
  if (byte != 0) { /* too long a frame is cut to a length that is still invalid */
    if (length < sizeof decoder->frame) decoder->frame[decoder->length++] = byte;
    return 0;
  }
  decoder->length = 0;
  if (length == 0) return 0;
  decoder->damaged++;
  if (length < 13 || length > MSN_MAX_PACKET + 1 || !unstuff(frame, length)) return 0;
  length--;
  if (msn_crc32(frame, length - 4) != number_of(frame + length - 4, 4)) return 0;
  packet->type = frame[0];
  packet->number = frame[1];
  packet->time = number_of(frame + 2, 6);
  packet->payload = frame + 8;
  packet->length = length - 12;
  if (!fields(packet)) return 0;
  decoder->damaged--;
  if (decoder->numbered) decoder->missed += (uint8_t)(packet->number - decoder->number - 1);
  decoder->numbered = 1;
  decoder->number = packet->number;
  return 1;
}
