/* Decodes standard input and prints each packet, then the counters: for test_packet_c.py. */
#include <inttypes.h>
#include <stdio.h>

#include "msn_packet.h"

static void show(const struct msn_packet *p) {
  printf("%u %u %" PRIu64, p->type, p->number, p->time);
  switch (p->type) {
    case MSN_SLIP: printf(" %u %" PRIu32 " %u", p->is.slip.channel, p->is.slip.p2p, p->is.slip.state); break;
    case MSN_CHANGE:
      printf(" %u %" PRIu32 " %u %u %u", p->is.change.channel, p->is.change.p2p, p->is.change.state,
             p->is.change.told, p->is.change.late);
      break;
    case MSN_STATES:
      printf(" %u %u", p->is.states.first, p->is.states.left);
      for (size_t i = 0; i < p->is.states.count; i++) printf(" %u", msn_state(p, i));
      break;
    case MSN_COP:
      printf(" %" PRId32 " %" PRId32 " %" PRIu64 " %u", p->is.cop.x, p->is.cop.y, p->is.cop.load,
             p->is.cop.pressed);
      break;
    case MSN_IMAGE:
      printf(" %u %u %" PRIu32, p->is.image.image, p->is.image.last, p->is.image.first);
      for (size_t i = 0; i < p->is.image.count; i++) printf(" %u", msn_taxel(p, i));
      break;
    case MSN_HEALTH: printf(" %" PRIu32 " %u", p->is.health.taxel, p->is.health.faults); break;
    case MSN_STATISTIC: printf(" %u %" PRIu32, p->is.statistic.index, p->is.statistic.value); break;
    case MSN_CLASS:
      printf(" %u %u %" PRIu32, p->is.classified.label, p->is.classified.told, p->is.classified.votes);
      break;
    case MSN_ANSWER:
      printf(" %u %u %u %" PRIu32, p->is.answer.tag, p->is.answer.status, p->is.answer.address,
             p->is.answer.data);
      break;
    default:
      for (size_t i = 0; i < p->length; i++) printf(" %u", p->payload[i]);
  }
  printf("\n");
}

int main(void) {
  static struct msn_decoder decoder;
  struct msn_packet packet;
  int byte;
  while ((byte = getchar()) != EOF) {
    if (msn_decode(&decoder, (uint8_t)byte, &packet)) show(&packet);
  }
  printf("damaged %" PRIu32 " missed %" PRIu32 "\n", decoder.damaged, decoder.missed);
  return 0;
}
