function [result, info] = convert(varargin)
% mbk.convert  Convert a recording to another format.
%
%   RESULT = mbk.convert(...) returns the text that 'mbk convert' prints.
%   [RESULT, INFO] = mbk.convert(...) also returns INFO.text (the same text), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.convert({'log.mat', 'log.h5'}, NAME, VALUE, ...)
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.read
  [result, info] = mbk.internal.run('convert', varargin);
end
