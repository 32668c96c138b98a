// Stands for the board's own drivers: the socket of which the number is the first argument takes and gives one message a
// packet. The second argument is how many messages to send. board.py starts it.
#include <poll.h>
#include <sys/socket.h>
#include <time.h>

#include <cstdio>
#include <cstdlib>

#include "board.hpp"

namespace {

std::int64_t now() {
    timespec time;
    clock_gettime(CLOCK_REALTIME, &time);
    return time.tv_sec * roslet::stamps::second + time.tv_nsec;
}

bool send_packet(void* context, const std::uint8_t* octets, std::size_t size) {
    return send(*static_cast<int*>(context), octets, size, 0) == static_cast<ssize_t>(size);
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 3) {
        return 2;
    }
    int socket = std::atoi(arguments[1]);
    const unsigned wanted = static_cast<unsigned>(std::atoi(arguments[2]));
    static Board board(send_packet, &socket);
    std::int64_t longest = 0;
    for (unsigned number = 0; number < wanted; ++number) {
        std::uint8_t packet[1024];
        pollfd arrival{socket, POLLIN, 0};
        if (!board.publish(now()) || poll(&arrival, 1, 5000) != 1) {
            std::printf("nothing came back\n");
            return 1;
        }
        const ssize_t size = recv(socket, packet, sizeof packet, 0);
        const Board::Heard heard = board.receive(packet, size < 0 ? 0 : static_cast<std::size_t>(size), now());
        if (heard.error != roslet::Error::none) {
            std::printf("%s: %s\n", heard.field, roslet::name(heard.error));
            return 1;
        }
        longest = heard.round_trip > longest ? heard.round_trip : longest;
        std::printf("came back [x: %f, y: %f, z: %f]\n", static_cast<double>(board.message().x),
                    static_cast<double>(board.message().y), static_cast<double>(board.message().z));
    }
    std::printf("heard %u, wrong %u, longest round trip %lld us\n", board.heard(), board.wrong(),
                static_cast<long long>(longest / 1000));
    return board.wrong() == 0 ? 0 : 1;
}
