// Drives one compiled design: clocks of any period and phase, pins by name, MII and GMII pins by queues of symbols, serial
// lines by queues of octets, waveforms.
//
// Linked with what Yosys's write_cxxrtl made of the design into one shared library with the C interface below.
// Times are picoseconds. A symbol of MII pins: bits 7..0 data, bit 8 data valid (rx_dv, tx_en), bit 9 error (rx_er, tx_er).

#include "design.h"  // of what Yosys made; a namespace cxxrtl_design with p_top in it
#include <cxxrtl/cxxrtl_vcd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace {

using Top = cxxrtl_design::p_top;
using Item = cxxrtl::debug_item;

const uint16_t VALID = 1 << 8;
const uint16_t ERROR = 1 << 9;

// What the design's edge detectors remember of its clocks; clocks.inc is made by units.py, a line for each.
cxxrtl::chunk_t *remembered(Top &top, const std::string &name) {
#define ROSLET_CLOCK(pin, member) \
	if (name == pin) \
		return top.member.data;
#include "clocks.inc"
	return nullptr;
}

struct Clock {
	cxxrtl::chunk_t *pin;
	cxxrtl::chunk_t *before; // what the edge detector remembers, where nothing but its rising edge matters; else null
	uint64_t period;
	uint64_t high;
	uint64_t rise; // when it rises next
	uint64_t fall;
	uint64_t cycles;
};

struct Frame {
	uint64_t start; // the clock edge at which its first symbol was taken
	uint64_t end;
	uint32_t gap; // cycles since the frame before
	std::vector<uint16_t> symbols;
};

// What the PHY has in its hands. Pins that the design does not have are null.
struct Mii {
	int rx_clock, tx_clock;
	Item *rxd, *rx_dv, *rx_er, *txd, *tx_en, *tx_er;
	uint32_t min_gap; // cycles between frames on rxd
	size_t max_symbols; // of one frame from the design; what is more is cut off
	std::deque<std::vector<uint16_t>> waiting;
	size_t at = 0;
	uint32_t idle; // cycles since the last symbol on rxd
	uint64_t sent = 0; // frames given to the design in full
	bool busy = false; // a frame from the design is under way
	uint32_t gap = 0;
	Frame frame;
	std::deque<Frame> frames;

	void sample(uint64_t now) {
		if (*tx_en->curr & 1) {
			if (!busy) {
				busy = true;
				frame = Frame{now, now, gap, {}};
			}
			if (frame.symbols.size() < max_symbols) {
				uint16_t symbol = VALID | (*txd->curr & 0xff);
				if (tx_er && (*tx_er->curr & 1))
					symbol |= ERROR;
				frame.symbols.push_back(symbol);
			}
		} else if (busy) {
			busy = false;
			gap = 1;
			frame.end = now;
			frames.push_back(std::move(frame));
		} else if (gap != UINT32_MAX) {
			gap++;
		}
	}

	void put(uint16_t symbol) {
		*rxd->next = symbol & 0xff;
		*rx_dv->next = symbol & VALID ? 1 : 0;
		if (rx_er)
			*rx_er->next = symbol & ERROR ? 1 : 0;
	}

	void drive() {
		if (waiting.empty() || (at == 0 && idle < min_gap)) {
			if (idle == 0)
				put(0);
			if (idle != UINT32_MAX)
				idle++;
			return;
		}
		const auto &symbols = waiting.front();
		put(symbols[at++]);
		idle = 0;
		if (at == symbols.size()) {
			waiting.pop_front();
			at = 0;
			sent++;
		}
	}
};

// The other end of a serial line, 8N1.
struct Uart {
	int clock; // at whose rising edges the pins are looked at
	Item *rx, *tx; // the design's
	uint64_t bit; // how long one takes
	std::deque<uint8_t> waiting; // for rx
	uint32_t bits = 0, left = 0; // of the octet that is being sent
	uint64_t next = 0; // when the next bit is due
	enum { IDLE, HEARS, BREAK } state = IDLE;
	uint32_t octet = 0, count = 0;
	uint64_t at = 0; // the middle of the next bit from tx
	std::deque<uint8_t> octets; // from tx
	uint32_t framing = 0; // octets without a stop bit

	void sample(uint64_t now) {
		const bool level = *tx->curr & 1;
		if (state == IDLE && !level) {
			state = HEARS;
			octet = count = 0;
			at = now + bit + bit / 2;
		} else if (state == BREAK && level) {
			state = IDLE;
		} else if (state == HEARS && now >= at) {
			at += bit;
			if (count < 8) {
				octet |= uint32_t(level) << count++;
			} else if (level) {
				octets.push_back(octet);
				state = IDLE;
			} else {
				framing++;
				state = BREAK;
			}
		}
	}

	void drive(uint64_t now) {
		if (now < next)
			return;
		if (!left) {
			if (waiting.empty())
				return;
			bits = uint32_t(waiting.front()) << 1 | 1 << 9; // start, 8 of data, stop
			left = 10;
			waiting.pop_front();
			if (now - next >= bit)
				next = now;
		}
		*rx->next = bits & 1;
		bits >>= 1;
		left--;
		next += bit;
	}
};

// A name in the design, of one or more parts.
struct Pin {
	std::vector<Item *> parts;
	uint32_t width;
};

struct Model {
	Top top;
	cxxrtl::debug_items items;
	std::vector<Pin> pins;
	std::vector<Clock> clocks;
	std::vector<Mii> ports;
	std::vector<Uart> lines;
	uint64_t now = 0;
	FILE *vcd_file = nullptr;
	std::unique_ptr<cxxrtl::vcd_writer> vcd;

	void sample_vcd() {
		vcd->sample(now);
		fwrite(vcd->buffer.data(), 1, vcd->buffer.size(), vcd_file);
		vcd->buffer.clear();
	}

	void close_vcd() {
		if (vcd_file) {
			fclose(vcd_file);
			vcd_file = nullptr;
			vcd.reset();
		}
	}

	~Model() { close_vcd(); }

	bool frame_out() const {
		for (const Mii &port : ports)
			if (!port.frames.empty())
				return true;
		return false;
	}

	// The falling edge of a clock of which only the rising one matters is made together with the next rising one, but where
	// somebody looks at the waveform.
	bool falls(const Clock &clock) const { return !clock.before || vcd; }

	void run(uint64_t until, bool stop_at_frame) {
		while (true) {
			uint64_t next = UINT64_MAX;
			for (const Clock &clock : clocks) {
				next = std::min(next, clock.rise);
				if (falls(clock))
					next = std::min(next, clock.fall);
			}
			if (next > until)
				break;
			now = next;
			bool fallen = false, rising = false;
			for (Clock &clock : clocks) {
				if (falls(clock) && clock.fall == now) {
					*clock.pin = 0;
					clock.fall = clock.rise + clock.high;
					fallen = true;
				}
				rising |= clock.rise == now;
			}
			// Where wires feed back, all must have come to rest before an edge.
			if (fallen || FEEDBACK)
				top.step();
			if (rising)
				rise();
			if (vcd) {
				top.step();
				sample_vcd();
			}
			if (rising && stop_at_frame && frame_out())
				return;
		}
		now = until;
	}

	// What eval() computes is what stands before the edge: registers change in commit(), and what follows from them shows in
	// the next eval(). So a PHY, which sees what stands before the edge, looks between the two.
	void rise() {
		for (Clock &clock : clocks)
			if (clock.rise == now) {
				if (clock.before)
					*clock.before = 0;
				*clock.pin = 1;
			}
		bool converged = top.eval();
		for (Mii &port : ports)
			if (port.txd && clocks[port.tx_clock].rise == now)
				port.sample(now);
		for (Uart &line : lines)
			if (clocks[line.clock].rise == now)
				line.sample(now);
		if (top.commit() && !converged)
			top.step();
		for (Mii &port : ports)
			if (port.rxd && clocks[port.rx_clock].rise == now)
				port.drive();
		for (Uart &line : lines)
			if (clocks[line.clock].rise == now)
				line.drive(now);
		for (Clock &clock : clocks)
			if (clock.rise == now) {
				clock.cycles++;
				clock.rise += clock.period;
				if (!falls(clock))
					clock.fall = clock.rise - clock.period + clock.high;
			}
	}
};

} // namespace

extern "C" {

Model *roslet_create() {
	Model *model = new Model;
	model->top.debug_info(&model->items, nullptr, "");
	return model;
}

void roslet_destroy(Model *model) { delete model; }

// The number by which a pin is known from now on, or -1. `width`: its bits; `input`: whether it may be set.
int roslet_find(Model *model, const char *name, uint32_t *width, int *input) {
	auto found = model->items.table.find(name);
	if (found == model->items.table.end() || found->second.front().type == Item::MEMORY)
		return -1;
	Pin pin{{}, 0};
	*input = 1;
	for (Item &part : found->second) {
		pin.parts.push_back(&part);
		pin.width = std::max<uint32_t>(pin.width, part.lsb_at + part.width);
		*input &= (part.flags & Item::INPUT) != 0 && part.lsb_at == 0;
	}
	*width = pin.width;
	model->pins.push_back(pin);
	return model->pins.size() - 1;
}

// `words` has room for all bits of the pin.
void roslet_get(Model *model, int pin, uint32_t *words) {
	Pin &found = model->pins[pin];
	std::fill(words, words + (found.width + 31) / 32, 0);
	for (Item *part : found.parts) {
		if (part->type == Item::OUTLINE)
			part->outline->eval();
		for (size_t bit = 0; bit < part->width; bit++)
			if (part->curr[bit / 32] >> (bit % 32) & 1)
				words[(part->lsb_at + bit) / 32] |= 1u << ((part->lsb_at + bit) % 32);
	}
}

// Of a pin that is an input.
void roslet_set(Model *model, int pin, const uint32_t *words) {
	Pin &found = model->pins[pin];
	std::copy(words, words + (found.width + 31) / 32, found.parts[0]->next);
}

// Let what was set be seen without a clock edge.
void roslet_settle(Model *model) { model->top.step(); }

// `rising`: nothing but its rising edge matters to the design.
int roslet_clock(Model *model, const char *name, int pin, uint64_t period, uint64_t high, uint64_t phase, int rising) {
	uint64_t rise = model->now + phase;
	cxxrtl::chunk_t *before = rising ? remembered(model->top, name) : nullptr;
	model->clocks.push_back(Clock{model->pins[pin].parts[0]->next, before, period, high, rise, rise + high, 0});
	return model->clocks.size() - 1;
}

uint64_t roslet_cycles(Model *model, int clock) { return model->clocks[clock].cycles; }

// Pins are numbers of roslet_find, -1 where the design has none.
int roslet_mii(Model *model, int rx_clock, int rxd, int rx_dv, int rx_er, int tx_clock, int txd, int tx_en, int tx_er,
               uint32_t min_gap, uint32_t max_symbols) {
	auto item = [&](int pin) { return pin < 0 ? nullptr : model->pins[pin].parts[0]; };
	Mii port{};
	port.rx_clock = rx_clock;
	port.rxd = item(rxd);
	port.rx_dv = item(rx_dv);
	port.rx_er = item(rx_er);
	port.tx_clock = tx_clock;
	port.txd = item(txd);
	port.tx_en = item(tx_en);
	port.tx_er = item(tx_er);
	port.min_gap = min_gap;
	port.max_symbols = max_symbols;
	port.idle = min_gap;
	model->ports.push_back(std::move(port));
	return model->ports.size() - 1;
}

void roslet_send(Model *model, int port, const uint16_t *symbols, uint32_t count) {
	if (count)
		model->ports[port].waiting.emplace_back(symbols, symbols + count);
}

// Frames that have not gone out in full, of the `roslet_send`s.
uint32_t roslet_waiting(Model *model, int port) { return model->ports[port].waiting.size(); }

// The number of symbols of the oldest frame that came out, of which up to `room` are written; 0: there is none. A frame that
// does not fit stays.
uint32_t roslet_receive(Model *model, int port, uint16_t *symbols, uint32_t room, uint64_t *start, uint64_t *end,
                        uint32_t *gap) {
	auto &frames = model->ports[port].frames;
	if (frames.empty())
		return 0;
	Frame &frame = frames.front();
	uint32_t count = frame.symbols.size();
	if (count > room)
		return count;
	std::copy(frame.symbols.begin(), frame.symbols.end(), symbols);
	*start = frame.start;
	*end = frame.end;
	*gap = frame.gap;
	frames.pop_front();
	return count;
}

// Pins are numbers of roslet_find. `bit`: how long one takes.
int roslet_uart(Model *model, int clock, int rx, int tx, uint64_t bit) {
	Uart line{};
	line.clock = clock;
	line.rx = model->pins[rx].parts[0];
	line.tx = model->pins[tx].parts[0];
	line.bit = bit;
	*line.rx->next = 1;
	model->lines.push_back(std::move(line));
	return model->lines.size() - 1;
}

void roslet_uart_send(Model *model, int line, const uint8_t *octets, uint32_t count) {
	auto &waiting = model->lines[line].waiting;
	waiting.insert(waiting.end(), octets, octets + count);
}

// Octets whose start bit has not gone out.
uint32_t roslet_uart_waiting(Model *model, int line) { return model->lines[line].waiting.size(); }

// The number of octets that came out since, which are written, `room` of them at most.
uint32_t roslet_uart_receive(Model *model, int line, uint8_t *octets, uint32_t room) {
	auto &found = model->lines[line].octets;
	const uint32_t count = std::min<size_t>(found.size(), room);
	std::copy_n(found.begin(), count, octets);
	found.erase(found.begin(), found.begin() + count);
	return count;
}

// How many octets from the design had no stop bit.
uint32_t roslet_uart_framing(Model *model, int line) { return model->lines[line].framing; }

uint64_t roslet_now(Model *model) { return model->now; }

void roslet_run(Model *model, uint64_t until, int stop_at_frame) { model->run(until, stop_at_frame != 0); }

// Whether the file could be made. `all`: memories too, which are large.
int roslet_vcd(Model *model, const char *path, int all) {
	model->close_vcd();
	model->vcd_file = fopen(path, "wb");
	if (!model->vcd_file)
		return 0;
	model->vcd.reset(new cxxrtl::vcd_writer);
	model->vcd->timescale(1, "ps");
	if (all)
		model->vcd->add(model->items);
	else
		model->vcd->add_without_memories(model->items);
	// Falling edges that nobody looked at until now.
	for (Clock &clock : model->clocks)
		if (clock.fall <= model->now) {
			*clock.pin = 0;
			clock.fall = clock.rise + clock.high;
		}
	model->top.step();
	model->sample_vcd();
	return 1;
}

void roslet_close_vcd(Model *model) { model->close_vcd(); }

} // extern "C"
