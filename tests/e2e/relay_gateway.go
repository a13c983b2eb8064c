// A gateway by Debian's grpc-go, against a relay: a stream for each robot on one connection, an
// event per robot and second. Run by test_clients.py; prints what it saw as JSON.
//
// grpc-go measures the bandwidth by a PING after DATA, and opens the connection's window before it.
// Source of the fields' numbers: proto/uplink/v1/relay.proto.
package main

import (
	"context"
	"crypto/tls"
	"crypto/x509"
	"encoding/binary"
	"encoding/json"
	"fmt"
	"io/ioutil"
	"os"
	"strconv"
	"time"

	"google.golang.org/grpc"
	"google.golang.org/grpc/credentials"
)

const path = "/uplink.v1.UplinkRelay/Relay"

// How long the last Acks are waited for.
const patience = 30 * time.Second

// raw passes messages on as their bytes.
type raw struct{}

func (raw) Marshal(message interface{}) ([]byte, error) { return *message.(*[]byte), nil }
func (raw) Unmarshal(bytes []byte, message interface{}) error {
	*message.(*[]byte) = append([]byte(nil), bytes...)
	return nil
}
func (raw) Name() string { return "proto" }

func number(field uint64, value uint64) []byte {
	var buffer [2 * binary.MaxVarintLen64]byte
	size := binary.PutUvarint(buffer[:], field<<3)
	size += binary.PutUvarint(buffer[size:], value)
	return buffer[:size]
}

func bytesField(field uint64, bytes []byte) []byte {
	var buffer [2 * binary.MaxVarintLen64]byte
	size := binary.PutUvarint(buffer[:], field<<3|2)
	size += binary.PutUvarint(buffer[size:], uint64(len(bytes)))
	return append(append([]byte(nil), buffer[:size]...), bytes...)
}

func join(parts ...[]byte) []byte {
	var all []byte
	for _, part := range parts {
		all = append(all, part...)
	}
	return all
}

func hello(ruri string) []byte {
	session := make([]byte, 16)
	return bytesField(1, join(bytesField(1, session), number(3, 1), bytesField(4, []byte(ruri))))
}

func event(seq uint64, payload []byte) []byte {
	uplink := join(number(1, seq), bytesField(2, payload))
	return bytesField(2, bytesField(1, uplink))
}

// field returns the content of a field of bytes or the value of a number, and what follows it.
func field(bytes []byte) (id uint64, content []byte, value uint64, rest []byte) {
	key, size := binary.Uvarint(bytes)
	value, more := binary.Uvarint(bytes[size:])
	rest = bytes[size+more:]
	if key&7 == 2 {
		content, rest = rest[:value], rest[value:]
	}
	return key >> 3, content, value, rest
}

// ackOf returns through_seq of a RelayResponse that is an Ack.
func ackOf(response []byte) uint64 {
	frame, content, _, _ := field(response)
	for frame == 2 && len(content) > 0 {
		var id, value uint64
		id, _, value, content = field(content)
		if id == 1 {
			return value
		}
	}
	return 0
}

type robot struct {
	Messages int    // that came, and so DATA frames at least
	Acked    uint64 // by the last Ack
	Error    string // how the stream ended, if not well
}

// stream sends an event per second, and ends when all of them are acked.
func stream(connection *grpc.ClientConn, ruri string, events uint64, payload []byte, start time.Time) robot {
	var seen robot
	context, cancel := context.WithTimeout(context.Background(), time.Duration(events)*time.Second+patience)
	defer cancel()
	description := grpc.StreamDesc{ServerStreams: true, ClientStreams: true}
	call, err := connection.NewStream(context, &description, path, grpc.ForceCodec(raw{}))
	if err == nil {
		frame := hello(ruri)
		err = call.SendMsg(&frame)
	}
	if err != nil {
		return robot{Error: err.Error()}
	}
	go func() {
		for seq := uint64(1); seq <= events; seq++ {
			time.Sleep(time.Until(start.Add(time.Duration(seq) * time.Second)))
			frame := event(seq, payload)
			if call.SendMsg(&frame) != nil {
				return
			}
		}
	}()
	for seen.Acked < events {
		var response []byte
		if err := call.RecvMsg(&response); err != nil {
			seen.Error = err.Error()
			return seen
		}
		seen.Messages++
		if acked := ackOf(response); acked > 0 {
			seen.Acked = acked
		}
	}
	return seen
}

func check(err error) {
	if err != nil {
		fmt.Fprintln(os.Stderr, err)
		os.Exit(1)
	}
}

func main() {
	target, authority, certificate, key := os.Args[1], os.Args[2], os.Args[3], os.Args[4]
	robots, err := strconv.Atoi(os.Args[5])
	check(err)
	seconds, err := strconv.ParseUint(os.Args[6], 10, 32)
	check(err)
	payload, err := ioutil.ReadFile(os.Args[7])
	check(err)
	pair, err := tls.LoadX509KeyPair(certificate, key)
	check(err)
	pem, err := ioutil.ReadFile(authority)
	check(err)
	roots := x509.NewCertPool()
	roots.AppendCertsFromPEM(pem)
	security := credentials.NewTLS(&tls.Config{
		Certificates: []tls.Certificate{pair}, RootCAs: roots, ServerName: "localhost",
	})
	connection, err := grpc.Dial(target, grpc.WithTransportCredentials(security), grpc.WithBlock(),
		grpc.WithTimeout(patience))
	check(err)

	results := make(chan robot)
	start := time.Now()
	for i := 0; i < robots; i++ {
		// Spread over the second, or one PING would measure the DATA of all.
		go func(ruri string, start time.Time) { results <- stream(connection, ruri, seconds, payload, start) }(
			fmt.Sprintf("rcan://example.org/acme/rover/g%d", i),
			start.Add(time.Second*time.Duration(i)/time.Duration(robots)))
	}
	total := robot{}
	for i := 0; i < robots; i++ {
		seen := <-results
		total.Messages += seen.Messages
		total.Acked += seen.Acked
		if total.Error == "" {
			total.Error = seen.Error
		}
	}
	// Its goodbye, while no stream was half-closed.
	check(connection.Close())
	check(json.NewEncoder(os.Stdout).Encode(total))
}
