function [result, info] = run(command, inputs, more)
% Runs a command. inputs: data, then names and values of options. more: further options, as texts.
  if nargin < 3
    more = {};
  end
  [data, words, documents, rest] = mbk.internal.take_data(inputs);
  options = [mbk.internal.option_texts(rest), more];
  [result, text, warnings, exit_code, messages] = mbk_mex('call', command, options, words, documents, ...
                                                               data.signals, data.metadata, data.events);
  info = struct('text', text, 'exit_code', exit_code, 'warnings', warnings, 'messages', {messages});
  for k = 1:numel(warnings)
    warning(['mbk:' strrep(warnings(k).code, '-', '_')], '%s', warnings(k).message);
  end
  for k = 1:numel(messages)
    warning('mbk:message', '%s', messages{k});
  end
end
