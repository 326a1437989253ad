#pragma once
/// @file http_server.hpp  A small web server inside the test, which can fail on demand.
///
/// HTTP/1.1 on 127.0.0.1 with byte ranges and connections that stay open, as much as libcurl and
/// GDAL's /vsicurl/ ask for. What was asked is in `requests()`; what goes wrong is chosen with
/// `set_delay`, `set_status` and `set_cut`, also while requests are running.
#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <list>
#include <mutex>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <optional>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <string_view>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace tarn::test_support {

/// Serves the files below a folder from its construction to its destruction.
class HttpServer {
public:
    struct Request {
        std::string method;
        std::string path;        ///< as sent, query included; the whole URL if sent to a proxy
        long from = -1, to = -1; ///< both inclusive, within the file; -1: no range or no file
        int status = 0;          ///< of the answer
        std::size_t bytes = 0;   ///< of body that the server set out to send
    };

    /// @throws std::runtime_error  no socket to be had
    explicit HttpServer(std::filesystem::path root)
        : root_(std::move(root)), stop_(::eventfd(0, EFD_CLOEXEC)),
          listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t length = sizeof address;
        auto* where = reinterpret_cast<sockaddr*>(&address);
        if (stop_.get() < 0 || listener_.get() < 0 || ::bind(listener_.get(), where, length) != 0 ||
            ::listen(listener_.get(), SOMAXCONN) != 0 ||
            ::getsockname(listener_.get(), where, &length) != 0)
            throw std::runtime_error("HttpServer: no socket on 127.0.0.1");
        port_ = ntohs(address.sin_port);
        acceptor_ = std::thread([this] { accept_connections(); });
    }

    /// Gives up delays and half-sent answers; returns once every thread has ended.
    ~HttpServer() {
        // Nobody reads it, so it stays readable and wakes every poll, those to come included.
        ::eventfd_write(stop_.get(), 1);
        acceptor_.join();
        for (Connection& connection : connections_)
            connection.thread.join();
    }
    HttpServer(const HttpServer&) = delete;
    HttpServer& operator=(const HttpServer&) = delete;

    std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

    /// In the order of arrival. A request is listed before its delay and its bytes before they are
    /// sent: what a client has seen is in here, also what it gave up waiting for.
    std::vector<Request> requests() const {
        const std::lock_guard lock(mutex_);
        return requests_;
    }

    /// Sum over `requests()`; without headers, and with what a client left unread.
    std::size_t bytes_sent() const {
        const std::lock_guard lock(mutex_);
        std::size_t sum = 0;
        for (const Request& request : requests_)
            sum += request.bytes;
        return sum;
    }

    void clear() {
        const std::lock_guard lock(mutex_);
        cleared_ += requests_.size();
        requests_.clear();
    }

    /// Before each answer. It ends early if the client goes away.
    void set_delay(std::chrono::milliseconds delay) { delay_ms_ = delay.count(); }

    /// Answers the next `times` requests with this status, -1: all of them; status 0: normal again.
    void set_status(int status, int times = -1) {
        const std::lock_guard lock(mutex_);
        status_ = status;
        status_times_ = times;
    }

    /// Closes the connection after half of each body; HEAD has none and is answered as always.
    void set_cut(bool cut) { cut_ = cut; }

private:
    class Descriptor {
    public:
        explicit Descriptor(int fd) : fd_(fd) {}
        ~Descriptor() {
            if (fd_ >= 0)
                ::close(fd_);
        }
        Descriptor(const Descriptor&) = delete;
        Descriptor& operator=(const Descriptor&) = delete;
        int get() const { return fd_; }

    private:
        int fd_;
    };

    struct Connection {
        std::thread thread;
        std::atomic<bool> done = false;
    };

    struct Answer {
        Request log;
        std::string head, body; ///< `body` as for GET; HEAD announces it only
        bool keep_alive = true;
    };

    struct Range {
        long from = 0, to = 0;
    };

    enum class Wake { Ready, TimedOut, Stopped };

    /// Waits for `events` on the socket or for the destructor.
    Wake wait(int socket, short events, std::optional<std::chrono::milliseconds> limit = {}) const {
        const auto end =
            std::chrono::steady_clock::now() + limit.value_or(std::chrono::milliseconds(0));
        for (;;) {
            int left_ms = -1;
            if (limit) {
                const auto left = std::chrono::ceil<std::chrono::milliseconds>(
                    end - std::chrono::steady_clock::now());
                left_ms = int(std::clamp<std::int64_t>(left.count(), 0, 1'000'000));
            }
            pollfd both[2] = {{stop_.get(), POLLIN, 0}, {socket, events, 0}};
            const int count = ::poll(both, 2, left_ms);
            if (both[0].revents || (count < 0 && errno != EINTR))
                return Wake::Stopped;
            if (count > 0)
                return Wake::Ready;
            if (limit && std::chrono::steady_clock::now() >= end)
                return Wake::TimedOut;
        }
    }

    void accept_connections() {
        while (wait(listener_.get(), POLLIN) == Wake::Ready) {
            // Only this thread touches the list until the destructor has joined it.
            std::erase_if(connections_, [](Connection& connection) {
                if (connection.done)
                    connection.thread.join();
                return connection.done.load();
            });
            // Not inherited: a program that a test starts must not hold the connection open.
            const int socket =
                ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
            if (socket < 0)
                continue;
            Connection& connection = connections_.emplace_back();
            connection.thread = std::thread([this, socket, &connection] {
                serve(socket);
                connection.done = true;
            });
        }
    }

    /// One connection, from its first request to its end.
    void serve(int fd) {
        const Descriptor socket(fd);
        const int on = 1; // else the second small packet of an answer waits for the client's ACK
        ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        std::string input;
        bool open = true;
        while (open) {
            const std::size_t end = input.find("\r\n\r\n");
            if (end == std::string::npos) {
                if (input.size() > 65536 || !receive(fd, input))
                    return;
                continue;
            }
            const Answer answer = answer_to(input.substr(0, end + 2));
            input.erase(0, end + 4);
            open = deliver(fd, answer);
        }
    }

    /// @returns whether there is more to come
    bool receive(int fd, std::string& input) const {
        char buffer[4096];
        for (;;) {
            const ssize_t got = ::recv(fd, buffer, sizeof buffer, 0);
            if (got > 0) {
                input.append(buffer, std::size_t(got));
                return true;
            }
            if (got == 0 || (errno != EAGAIN && errno != EINTR) || wait(fd, POLLIN) != Wake::Ready)
                return false;
        }
    }

    /// @returns whether all of it went out
    bool send(int fd, std::string_view data) const {
        while (!data.empty()) {
            // MSG_NOSIGNAL: a client that went away must not end the test with SIGPIPE.
            const ssize_t put = ::send(fd, data.data(), data.size(), MSG_NOSIGNAL);
            if (put >= 0)
                data.remove_prefix(std::size_t(put));
            else if ((errno != EAGAIN && errno != EINTR) || wait(fd, POLLOUT) != Wake::Ready)
                return false;
        }
        return true;
    }

    /// @returns whether the connection is good for another request
    bool deliver(int fd, const Answer& answer) {
        const std::size_t entry = log(answer.log);
        const std::chrono::milliseconds delay(delay_ms_);
        if (delay.count() > 0 && wait(fd, POLLRDHUP, delay) != Wake::TimedOut)
            return false;
        std::string_view body = answer.log.method == "HEAD" ? std::string_view() : answer.body;
        const bool cut = cut_ && !body.empty();
        if (cut)
            body = body.substr(0, body.size() / 2);
        log_bytes(entry, body.size());
        return send(fd, answer.head) && send(fd, body) && !cut && answer.keep_alive;
    }

    /// @returns what `log_bytes` wants
    std::size_t log(const Request& request) {
        const std::lock_guard lock(mutex_);
        requests_.push_back(request);
        return cleared_ + requests_.size() - 1;
    }

    void log_bytes(std::size_t entry, std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        if (entry >= cleared_) // the log may have been cleared during the delay
            requests_[entry - cleared_].bytes = bytes;
    }

    int take_status() {
        const std::lock_guard lock(mutex_);
        if (status_ == 0 || status_times_ == 0)
            return 0;
        if (status_times_ > 0)
            --status_times_;
        return status_;
    }

    /// @param head  the request line and the fields, each with its line's end
    Answer answer_to(const std::string& head) {
        Answer answer;
        const std::string line = head.substr(0, head.find("\r\n"));
        const std::size_t first = line.find(' '), last = line.rfind(' ');
        std::string version;
        if (first != std::string::npos && last > first) {
            answer.log.method = line.substr(0, first);
            answer.log.path = line.substr(first + 1, last - first - 1);
            version = line.substr(last + 1);
        }
        const std::string& method = answer.log.method;
        const std::string path = file_path(answer.log.path), connection = field(head, "connection");
        answer.keep_alive =
            version == "HTTP/1.1" ? connection != "close" : connection == "keep-alive";
        if (const int status = take_status(); status != 0) {
            refuse(answer, status);
        } else if (!version.starts_with("HTTP/1.")) {
            answer.keep_alive = false; // no telling what follows
            refuse(answer, 400);
        } else if (method != "GET" && method != "HEAD") {
            answer.keep_alive = false; // what follows may be a body
            refuse(answer, 405);
        } else if (("/" + path + "/").find("/../") != std::string::npos) {
            refuse(answer, 403);
        } else {
            answer_file(answer, root_ / path, method == "GET" ? field(head, "range") : "");
        }
        return answer;
    }

    static void answer_file(Answer& answer, const std::filesystem::path& path,
                            const std::string& range_field) {
        std::error_code error; // a name too long, a folder that is not ours: as if missing
        std::ifstream in;
        if (std::filesystem::is_regular_file(path, error))
            in.open(path, std::ios::binary | std::ios::ate);
        if (!in.is_open())
            return refuse(answer, 404);
        const long size = long(in.tellg());
        const std::optional<Range> asked = range(range_field, size);
        if (asked) {
            answer.log.from = asked->from;
            answer.log.to = asked->to;
        }
        if (asked && asked->from >= size)
            return refuse(answer, 416, "Content-Range: bytes */" + std::to_string(size) + "\r\n");
        const Range part = asked.value_or(Range{0, size - 1});
        answer.body.resize(std::size_t(part.to - part.from + 1));
        in.seekg(part.from);
        in.read(answer.body.data(), std::streamsize(answer.body.size()));
        // Always the same, so that runs do not differ.
        std::string fields = "Content-Type: application/octet-stream\r\n"
                             "Last-Modified: Thu, 01 Jan 2015 00:00:00 GMT\r\n"
                             "ETag: \"tarn\"\r\n";
        if (asked)
            fields += "Content-Range: bytes " + std::to_string(part.from) + "-" +
                      std::to_string(part.to) + "/" + std::to_string(size) + "\r\n";
        write_head(answer, asked ? 206 : 200, fields);
    }

    static void refuse(Answer& answer, int status, const std::string& fields = "") {
        answer.body = std::to_string(status) + " " + reason(status) + "\n";
        write_head(answer, status, fields);
    }

    /// Once the body is there, whose length it tells.
    /// @param fields  each with its line's end
    static void write_head(Answer& answer, int status, const std::string& fields) {
        answer.log.status = status;
        answer.head = "HTTP/1.1 " + std::to_string(status) + " " + reason(status) +
                      "\r\nServer: tarn-test\r\nAccept-Ranges: bytes\r\n" + fields +
                      "Content-Length: " + std::to_string(answer.body.size()) + "\r\n" +
                      (answer.keep_alive ? "" : "Connection: close\r\n") + "\r\n";
    }

    static std::string lower(std::string_view text) {
        std::string out(text);
        std::transform(out.begin(), out.end(), out.begin(),
                       [](unsigned char c) { return char(std::tolower(c)); });
        return out;
    }

    /// A field's value in lower case, "" where it is missing.
    static std::string field(const std::string& head, std::string_view name) {
        const std::string fields = lower(head), key = "\r\n" + std::string(name) + ":";
        const std::size_t at = fields.find(key);
        if (at == std::string::npos)
            return "";
        std::string value =
            fields.substr(at + key.size(), fields.find("\r\n", at + 2) - at - key.size());
        value.erase(0, value.find_first_not_of(" \t"));
        value.erase(value.find_last_not_of(" \t") + 1);
        return value;
    }

    /// The file below the root that a request's target names, without the leading slash.
    static std::string file_path(std::string_view target) {
        if (target.starts_with("http://")) { // as clients write it to a proxy
            target.remove_prefix(7);
            target.remove_prefix(std::min(target.find('/'), target.size()));
        }
        target = target.substr(0, target.find_first_of("?#"));
        std::string out;
        for (std::size_t i = 0; i < target.size(); ++i) {
            unsigned char byte = 0;
            const char* digits = target.data() + i + 1;
            if (target[i] == '%' && i + 2 < target.size() &&
                std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
                out += char(byte);
                i += 2;
            } else {
                out += target[i];
            }
        }
        // With a leading slash left, root_ / out would be a path of its own, outside the root.
        out.erase(0, std::min(out.find_first_not_of('/'), out.size()));
        return out;
    }

    /// What a Range field asks of a file, `to` cut to it. None, and so all of the file, for what
    /// this server does not know: other units, several ranges.
    static std::optional<Range> range(std::string_view value, long size) {
        if (!value.starts_with("bytes="))
            return {};
        value.remove_prefix(6);
        const std::size_t dash = value.find('-');
        if (dash == std::string_view::npos)
            return {};
        const auto from = number(value.substr(0, dash)), to = number(value.substr(dash + 1));
        if (from && to && *from <= *to)
            return Range{*from, std::min(*to, size - 1)};
        if (from && dash + 1 == value.size())
            return Range{*from, size - 1};
        if (dash == 0 && to)
            return Range{std::max(size - *to, 0L), size - 1};
        return {};
    }

    static std::optional<long> number(std::string_view digits) {
        long out = 0;
        const char* end = digits.data() + digits.size();
        const auto [stop, error] = std::from_chars(digits.data(), end, out);
        if (digits.empty() || digits.front() == '-' || stop != end || error != std::errc())
            return {};
        return out;
    }

    static std::string reason(int status) {
        switch (status) {
        case 200:
            return "OK";
        case 206:
            return "Partial Content";
        case 400:
            return "Bad Request";
        case 403:
            return "Forbidden";
        case 404:
            return "Not Found";
        case 405:
            return "Method Not Allowed";
        case 416:
            return "Range Not Satisfiable";
        case 429:
            return "Too Many Requests";
        case 500:
            return "Internal Server Error";
        case 502:
            return "Bad Gateway";
        case 503:
            return "Service Unavailable";
        case 504:
            return "Gateway Timeout";
        default:
            return "Status";
        }
    }

    std::filesystem::path root_;
    Descriptor stop_, listener_;
    int port_ = 0;
    std::atomic<std::int64_t> delay_ms_ = 0;
    std::atomic<bool> cut_ = false;
    mutable std::mutex mutex_; ///< for the next four
    int status_ = 0, status_times_ = -1;
    std::size_t cleared_ = 0; ///< entries that `clear` took away
    std::vector<Request> requests_;
    std::list<Connection> connections_;
    std::thread acceptor_;
};

} // namespace tarn::test_support
