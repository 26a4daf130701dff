/* containers.h - heads of packed files made up, and bytes of heads changed. */
#ifndef CONTAINERS_H
#define CONTAINERS_H

#include "common/packed/file/envelope.h"
#include "terrains.h"

/* A container whose levels follow each other; models of some random bytes. */
tc_container container_make(test_random *r);

/* The same of a planet's cap. */
tc_container container_make_cap(test_random *r, int64_t side, double z_base);

/* The bytes of an envelope, its charts placed and, where asked for, its levels laid out; the caller's to free. The
 * second one is of one chart, as long as the container says, and borrows it. */
tc_byte_writer envelope_bytes(tc_envelope *envelope, bool lay_out);
tc_byte_writer envelope_of_one(const tc_container *container, bool lay_out);

/* Where a chart's row of the table and the head of its container stand in an envelope's bytes. */
size_t envelope_row_at(int chart);
size_t envelope_head_at(const uint8_t *bytes, int chart);

/* Gives all heads of an envelope the checksums of their bytes. */
void envelope_sign(uint8_t *bytes);

#endif
